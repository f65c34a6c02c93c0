// Wavefront .mtl files, the materials of .obj files.
#pragma once

#include "corpus/model/model_builder.h"

#include <functional>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::corpus {

// The statements of one material in a .mtl file. Colours are display-referred.
struct MtlMaterial {
    glm::dvec3 diffuse{0.6}, emission{0.0};
    double exponent = 0.0;
    std::optional<double> roughness, metal;
    std::string picture, emission_picture, normal_picture, bump_picture;
    std::string roughness_picture, metal_picture, opacity_picture;
    TextureUse placed; // how map_Kd lies on the surface, without its image
    double opacity = 1.0;
    double bump_scale = 1.0;
    double clear = 0.0, clear_roughness = 0.0;
    std::set<std::string> ignored; // statements

    // Reads a statement. Returns false if `rest` is not a value of the keyword, which is in lower
    // case. `folder` is that of the file.
    bool read(const std::string& keyword, std::string_view rest, const std::string& folder);
};

// The materials of all .mtl files of one .obj file.
class MtlReader {
public:
    // Errors: io; invalid_file, naming the file and the line.
    Status read(const std::string& path);
    // The index of the material in the model; 0 if no material has this name.
    std::uint32_t find(std::string_view name) const;
    // Adds a grey material, for faces without a known one, and the materials of the files. Notes
    // what is ignored.
    void finish(ModelBuilder& builder) const;

private:
    std::vector<MtlMaterial> materials_;
    std::map<std::string, std::size_t, std::less<>> numbers_;
};

} // namespace tessera::corpus
