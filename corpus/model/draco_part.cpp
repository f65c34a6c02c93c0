#include "corpus/model/readers.h"

#include <draco/compression/decode.h>
#include <glm/vec4.hpp>

namespace tessera::corpus {
namespace {

template <class Vector>
Status take(const draco::Mesh& mesh, const DracoUse& use, const std::string& name,
            std::vector<Vector>& values, float otherwise) {
    const auto it = use.attributes.find(name);
    if (it == use.attributes.end())
        return {};
    const draco::PointAttribute* const attribute =
        it->second < 0 ? nullptr
                       : mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(it->second));
    if (attribute == nullptr || attribute->num_components() > Vector::length())
        return {ErrorCode::invalid_file, "the Draco stream has no usable attribute " + name +
                                             ", id " + std::to_string(it->second)};
    values.assign(mesh.num_points(), Vector(otherwise));
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
        const draco::AttributeValueIndex at = attribute->mapped_index(draco::PointIndex(i));
        std::array<float, 4> x{otherwise, otherwise, otherwise, otherwise};
        if (at.value() >= attribute->size() ||
            !attribute->ConvertValue<float>(at, attribute->num_components(), x.data()))
            return {ErrorCode::invalid_file,
                    "the Draco stream's " + name + " " + std::to_string(i) + " is missing"};
        for (int c = 0; c < attribute->num_components(); ++c)
            values[i][c] = x[static_cast<std::size_t>(c)];
    }
    return {};
}

} // namespace

Status decode_draco_part(std::span<const unsigned char> stream, const DracoUse& use,
                         const Attributes& attributes, ModelPart& part) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
        return {ErrorCode::invalid_file,
                std::string("the Draco stream is damaged: ") + decoded.status().error_msg()};
    const draco::Mesh& mesh = *decoded.value();
    if (mesh.num_points() > most_vertices || mesh.num_faces() > most_vertices)
        return {ErrorCode::unsupported, "the Draco stream has too many vertices or triangles"};
    const auto read = [&](const std::string& name, auto& values, int, float otherwise) {
        return take(mesh, use, name, values, otherwise);
    };
    TESSERA_TRY(read_attributes(attributes, part, read));
    for (std::uint32_t i = 0; i < mesh.num_faces(); ++i)
        for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(i)))
            part.indices.push_back(corner.value());
    return {};
}

} // namespace tessera::corpus
