// The attributes of a glTF primitive, wherever its numbers are.
#pragma once

#include "corpus/model/model_builder.h"
#include "format/status.h"

namespace tessera::corpus {

// The sets of texture coordinates in the file that ModelPart::uv holds.
using UvSets = std::array<unsigned, 2>;

// What to read of a primitive.
struct Attributes {
    UvSets uv{0, 1};
    bool has_skin = false;
};

constexpr int most_joint_sets = 4; // 16 joints a vertex

// Calls read(name, values, least, otherwise) for each attribute. `least`: components that it must
// have; `otherwise`: those that it lacks.
template <class Read>
Status read_attributes(const Attributes& attributes, ModelPart& part, const Read& read) {
    TESSERA_TRY(read("POSITION", part.positions, 3, 0.0f));
    TESSERA_TRY(read("NORMAL", part.normals, 3, 0.0f));
    TESSERA_TRY(read("TANGENT", part.tangents, 4, 0.0f));
    for (std::size_t s = 0; s < attributes.uv.size(); ++s)
        TESSERA_TRY(read("TEXCOORD_" + std::to_string(attributes.uv[s]), part.uv[s], 2, 0.0f));
    TESSERA_TRY(read("COLOR_0", part.colours, 3, 1.0f));
    for (int s = 0; attributes.has_skin && s < most_joint_sets; ++s) {
        SkinUse use;
        TESSERA_TRY(read("JOINTS_" + std::to_string(s), use.joints, 4, 0.0f));
        TESSERA_TRY(read("WEIGHTS_" + std::to_string(s), use.weights, 4, 0.0f));
        if (!use.joints.empty())
            part.skin.push_back(std::move(use));
    }
    return {};
}

} // namespace tessera::corpus
