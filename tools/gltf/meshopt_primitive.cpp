#include "tools/gltf/meshopt_primitive.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <meshoptimizer.h>

namespace tessera {
namespace {

constexpr int grid_bits = 16, place_bits = 15, direction_bits = 12; // with the sign
constexpr std::size_t direction_bytes = 4 * sizeof(std::int16_t);

MeshoptView attribute_view(const void* values, std::size_t count, std::size_t stride,
                           const char* filter) {
    MeshoptView view{.count = count, .stride = stride, .filter = filter};
    view.stream.resize(meshopt_encodeVertexBufferBound(count, stride));
    view.stream.resize(
        meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(view.stream.data()),
                                   view.stream.size(), values, count, stride));
    return view;
}

// The filter EXPONENTIAL: each number is an integer of 24 bits times a power of two. One power for all
// vertices, unlike that of meshoptimizer's encoder, makes a grid, whose differences are small.
// Replaces the values by those that readers get.
template <class Vector> MeshoptView grid_view(std::vector<Vector>& values, int bits) {
    float most = 0.0f;
    for (const Vector& value : values)
        for (glm::length_t c = 0; c < Vector::length(); ++c)
            most = std::max(most, std::abs(value[c]));
    int size = 0; // most < 2^size, or the two are equal
    std::frexp(most, &size);
    if (most == std::ldexp(0.5f, size))
        --size;
    const int exponent = std::clamp(size - (bits - 1), -100, 100);
    std::vector<std::uint32_t> words;
    for (Vector& value : values)
        for (glm::length_t c = 0; c < Vector::length(); ++c) {
            const long number = std::lround(std::ldexp(value[c], -exponent));
            words.push_back(static_cast<std::uint32_t>(exponent) << 24 |
                            (static_cast<std::uint32_t>(number) & 0xFFFFFFu));
            value[c] = std::ldexp(static_cast<float>(number), exponent);
        }
    return attribute_view(words.data(), values.size(), sizeof(Vector), "EXPONENTIAL");
}

MeshoptView direction_view(const std::vector<glm::vec4>& directions) {
    std::vector<std::int16_t> coded(4 * directions.size());
    meshopt_encodeFilterOct(coded.data(), directions.size(), direction_bytes, direction_bits,
                            &directions[0].x);
    return attribute_view(coded.data(), directions.size(), direction_bytes, "OCTAHEDRAL");
}

MeshoptView triangle_view(const std::vector<std::uint32_t>& corners, std::size_t vertices) {
    MeshoptView view{.count = corners.size(), .stride = sizeof(std::uint32_t), .mode = "TRIANGLES"};
    view.stream.resize(meshopt_encodeIndexBufferBound(corners.size(), vertices));
    view.stream.resize(
        meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(view.stream.data()),
                                  view.stream.size(), corners.data(), corners.size()));
    return view;
}

} // namespace

MeshoptPrimitive meshopt_primitive(const GltfMesh& gltf) {
    const SurfaceMesh& mesh = gltf.mesh;
    std::vector<std::uint32_t> corners;
    for (const auto& triangle : mesh.triangles)
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    // Both streams are small if triangles and vertices are in the order of their use.
    meshopt_optimizeVertexCacheStrip(corners.data(), corners.data(), corners.size(),
                                     mesh.positions.size());
    std::vector<std::uint32_t> moved(mesh.positions.size());
    const std::size_t vertices = meshopt_optimizeVertexFetchRemap(
        moved.data(), corners.data(), corners.size(), mesh.positions.size());
    meshopt_remapIndexBuffer(corners.data(), corners.data(), corners.size(), moved.data());
    std::vector<glm::vec3> positions(vertices);
    std::vector<glm::vec2> uv(vertices);
    std::vector<glm::vec4> normals(vertices), tangents(vertices);
    for (std::size_t i = 0; i < moved.size(); ++i)
        if (moved[i] != ~0u) { // ~0: no triangle uses the vertex
            positions[moved[i]] = mesh.positions[i];
            uv[moved[i]] = mesh.uv[i];
            normals[moved[i]] = glm::vec4(mesh.normals[i], 0.0f);
            tangents[moved[i]] = gltf.tangents[i];
        }
    MeshoptPrimitive out{.vertices = vertices, .triangles = mesh.triangles.size()};
    out.positions = grid_view(positions, grid_bits);
    out.uv = grid_view(uv, place_bits);
    out.normals = direction_view(normals);
    out.tangents = direction_view(tangents);
    out.indices = triangle_view(corners, vertices);
    out.low = out.high = positions.front();
    for (const glm::vec3& p : positions) {
        out.low = glm::min(out.low, p);
        out.high = glm::max(out.high, p);
    }
    return out;
}

} // namespace tessera
