#include "format/surface/mesh_check.h"

#include <algorithm>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <new>
#include <optional>
#include <string>

namespace tessera {
namespace {

using Kind = draco::GeometryAttribute;

Status check_bits(const char* what, unsigned bits, unsigned low, unsigned high) {
    if (low <= bits && bits <= high)
        return {};
    return {ErrorCode::bad_argument, std::string("the mesh's ") + what + " bits are " +
                                         std::to_string(bits) + ", outside " + std::to_string(low) +
                                         ".." + std::to_string(high)};
}

// Adds an attribute with one value per vertex. Equal values are merged later, by
// DeduplicateAttributeValues(), so that the coder sees which vertices of different charts coincide.
template <int n, class Values>
int add_attribute(draco::Mesh& out, Kind::Type type, Values value_of) {
    draco::GeometryAttribute form;
    form.Init(type, nullptr, n, draco::DT_FLOAT32, false, n * sizeof(float), 0);
    const int id = out.AddAttribute(form, true, out.num_points());
    for (std::uint32_t i = 0; i < out.num_points(); ++i) {
        const auto value = value_of(i) + 0.0f; // makes -0 +0, so that equal values have equal bytes
        out.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &value[0]);
    }
    return id;
}

struct DracoMesh {
    draco::Mesh mesh;
    int position = -1, uv = -1, normal = -1; // ids of the attributes
};

void fill(DracoMesh& out, const SurfaceMesh& mesh, bool with_uv, bool with_normals) {
    out.mesh.set_num_points(static_cast<std::uint32_t>(mesh.positions.size()));
    for (const auto& [a, b, c] : mesh.triangles)
        if (!has_equal_corners(mesh, {a, b, c}))
            out.mesh.AddFace({draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
    out.position =
        add_attribute<3>(out.mesh, Kind::POSITION, [&](auto i) { return mesh.positions[i]; });
    if (with_uv)
        out.uv = add_attribute<2>(out.mesh, Kind::TEX_COORD,
                                  [&](auto i) { return glm::clamp(mesh.uv[i], 0.0f, 1.0f); });
    if (with_normals)
        out.normal = add_attribute<3>(out.mesh, Kind::NORMAL,
                                      [&](auto i) { return glm::normalize(mesh.normals[i]); });
    out.mesh.DeduplicateAttributeValues();
    out.mesh.DeduplicatePointIds();
}

// The prediction methods of a stream. Which of them give the smallest stream depends on the mesh.
struct Prediction {
    int traversal = draco::MESH_EDGEBREAKER_VALENCE_ENCODING;
    int position = draco::MESH_PREDICTION_CONSTRAINED_MULTI_PARALLELOGRAM;
    int uv = draco::MESH_PREDICTION_TEX_COORDS_PORTABLE;
    int normal = draco::MESH_PREDICTION_GEOMETRIC_NORMAL;
};

// Empty if Draco cannot encode the mesh with these methods.
std::vector<std::byte> encode_with(const DracoMesh& mesh, const MeshQuantisation& bits,
                                   const Prediction& prediction) {
    draco::ExpertEncoder encoder(mesh.mesh);
    encoder.SetSpeedOptions(0, 0);
    // Draco's other method, sequential encoding, writes streams that Draco cannot read.
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    encoder.SetEncodingSubmethod(prediction.traversal);
    const float origin[2] = {0, 0};
    encoder.SetAttributeQuantization(mesh.position, static_cast<int>(bits.position_bits));
    bool ok = encoder.SetAttributePredictionScheme(mesh.position, prediction.position).ok();
    if (mesh.uv >= 0) {
        encoder.SetAttributeExplicitQuantization(mesh.uv, static_cast<int>(bits.uv_bits), 2, origin,
                                                 1);
        ok = ok && encoder.SetAttributePredictionScheme(mesh.uv, prediction.uv).ok();
    }
    if (mesh.normal >= 0) {
        encoder.SetAttributeQuantization(mesh.normal, static_cast<int>(bits.normal_bits));
        ok = ok && encoder.SetAttributePredictionScheme(mesh.normal, prediction.normal).ok();
    }
    draco::EncoderBuffer buffer;
    if (!ok || !encoder.EncodeToBuffer(&buffer).ok())
        return {};
    const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
    return {bytes.begin(), bytes.end()};
}

// Tries the methods of each attribute separately, because their sizes do not depend on each other.
std::vector<std::byte> smallest_stream(const DracoMesh& mesh, const MeshQuantisation& bits) {
    Prediction best;
    std::vector<std::byte> stream = encode_with(mesh, bits, best);
    const auto attempt = [&](int Prediction::*member, int value) {
        Prediction other = best;
        other.*member = value;
        std::vector<std::byte> bytes = encode_with(mesh, bits, other);
        if (!bytes.empty() && (stream.empty() || bytes.size() < stream.size())) {
            stream = std::move(bytes);
            best = other;
        }
    };
    attempt(&Prediction::traversal, draco::MESH_EDGEBREAKER_STANDARD_ENCODING);
    attempt(&Prediction::position, draco::MESH_PREDICTION_PARALLELOGRAM);
    if (mesh.uv >= 0) {
        attempt(&Prediction::uv, draco::MESH_PREDICTION_CONSTRAINED_MULTI_PARALLELOGRAM);
        attempt(&Prediction::uv, draco::MESH_PREDICTION_PARALLELOGRAM);
        attempt(&Prediction::uv, draco::PREDICTION_DIFFERENCE);
    }
    if (mesh.normal >= 0)
        attempt(&Prediction::normal, draco::PREDICTION_DIFFERENCE);
    return stream;
}

Result<std::vector<std::byte>> encode(const SurfaceMesh& mesh, const MeshQuantisation& bits,
                                      bool with_uv) {
    TESSERA_TRY(check_bits("position", bits.position_bits, 4, 24));
    if (with_uv)
        TESSERA_TRY(check_bits("uv", bits.uv_bits, 4, 24));
    if (bits.normal_bits != 0)
        TESSERA_TRY(check_bits("normal", bits.normal_bits, 3, 16));
    TESSERA_TRY(check_mesh(mesh, with_uv, bits.normal_bits != 0, ErrorCode::bad_argument));
    const auto flat = std::ranges::count_if(
        mesh.triangles, [&](const auto& t) { return has_equal_corners(mesh, t); });
    const std::size_t wanted = mesh.triangles.size() - static_cast<std::size_t>(flat);
    if (wanted == 0)
        return Status{ErrorCode::bad_argument,
                      "the mesh has no triangle with three different corners"};
    try {
        DracoMesh copy;
        fill(copy, mesh, with_uv, bits.normal_bits != 0);
        std::vector<std::byte> stream = smallest_stream(copy, bits);
        if (stream.empty())
            return Status{ErrorCode::runtime, "Draco could not encode the mesh"};
        constexpr auto no_limit = std::numeric_limits<std::uint64_t>::max();
        const Result<SurfaceMesh> back =
            with_uv ? decode_mesh(stream, no_limit) : decode_shape(stream, no_limit);
        if (!back)
            return Status{ErrorCode::runtime,
                          "the encoded mesh does not decode: " + back.status().message()};
        if (back->triangles.size() != wanted)
            return Status{ErrorCode::runtime,
                          "the encoded mesh has " + std::to_string(back->triangles.size()) +
                              " triangles instead of " + std::to_string(wanted)};
        return stream;
    } catch (const std::bad_alloc&) {
        return Status{ErrorCode::runtime, "out of memory while encoding the mesh"};
    }
}

} // namespace

Result<std::vector<std::byte>> encode_mesh(const SurfaceMesh& mesh, const MeshQuantisation& bits) {
    return encode(mesh, bits, true);
}

Result<std::vector<std::byte>> encode_shape(const SurfaceMesh& mesh, const MeshQuantisation& bits) {
    return encode(mesh, bits, false);
}

} // namespace tessera
