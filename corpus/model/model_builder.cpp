#include "corpus/model/image_file.h"
#include "corpus/model/readers.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace tessera::corpus {
namespace {

constexpr std::size_t most_triangles = std::size_t{1} << 22;
constexpr float largest_coordinate = 1e15f; // squares of differences stay finite
constexpr double paper_radius = 3.5;

template <class Vector> bool is_sound(const Vector& x) {
    for (glm::length_t i = 0; i < x.length(); ++i)
        if (!(std::abs(x[i]) <= largest_coordinate)) // NaN is not
            return false;
    return true;
}

template <class Vector>
Status check_values(const ModelPart& part, const char* what, const std::vector<Vector>& values) {
    if (values.empty())
        return {};
    if (values.size() != part.positions.size())
        return {ErrorCode::invalid_file,
                part.name + " has " + std::to_string(part.positions.size()) + " positions and " +
                    std::to_string(values.size()) + " of " + what};
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!is_sound(values[i]))
            return {ErrorCode::invalid_file, part.name + ": " + what + " " + std::to_string(i) +
                                                 " is not a number, or too large"};
    return {};
}

Status check(const ModelPart& part) {
    TESSERA_TRY(check_values(part, "position", part.positions));
    TESSERA_TRY(check_values(part, "normal", part.normals));
    TESSERA_TRY(check_values(part, "tangent", part.tangents));
    TESSERA_TRY(check_values(part, "colour", part.colours));
    for (const auto& uv : part.uv)
        TESSERA_TRY(check_values(part, "uv", uv));
    if (part.indices.size() % 3 != 0)
        return {ErrorCode::invalid_file, part.name + " has " + std::to_string(part.indices.size()) +
                                             " indices, not three a triangle"};
    for (std::size_t i = 0; i < part.indices.size(); ++i)
        if (part.indices[i] >= part.positions.size())
            return {ErrorCode::invalid_file, part.name + ": triangle " + std::to_string(i / 3) +
                                                 " has vertex " + std::to_string(part.indices[i]) +
                                                 " of " + std::to_string(part.positions.size())};
    return {};
}

glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise) {
    const double length = glm::length(v);
    return length > 1e-12 ? v / length : otherwise;
}

} // namespace

Status ModelBuilder::add(const ModelPart& part, const glm::dmat4& to_world) {
    TESSERA_TRY(check(part));
    if (model_.triangles.size() + part.indices.size() / 3 > most_triangles)
        return {ErrorCode::unsupported,
                part.name + ": more than " + std::to_string(most_triangles) + " triangles in all"};
    const glm::dmat3 linear(to_world);
    const double determinant = glm::determinant(linear);
    if (!(std::abs(determinant) > 1e-30) || !(std::abs(determinant) < 1e30))
        return {ErrorCode::invalid_file, part.name + " has a transform that flattens or bursts it"};
    const glm::dmat3 of_normals = glm::transpose(glm::inverse(linear));
    const auto make = [&](std::uint32_t i, const glm::dvec3& face) {
        ModelVertex v;
        v.position = glm::vec3(glm::dvec3(to_world * glm::dvec4(part.positions[i], 1.0)));
        v.normal = glm::vec3(
            part.normals.empty() ? face : unit_or(of_normals * glm::dvec3(part.normals[i]), face));
        if (!part.tangents.empty()) {
            const glm::dvec3 t = linear * glm::dvec3(part.tangents[i]);
            if (glm::length(t) > 1e-12)
                v.tangent =
                    glm::vec4(glm::vec3(glm::normalize(t)), part.tangents[i].w < 0 ? -1 : 1);
        }
        for (std::size_t s = 0; s < 2; ++s)
            if (!part.uv[s].empty())
                v.uv[s] = part.uv[s][i];
        if (!part.colours.empty())
            v.colour = part.colours[i];
        return v;
    };
    constexpr std::uint32_t none = UINT32_MAX;
    // Where normals are the triangles' own, no two share a vertex.
    std::vector<std::uint32_t> made(part.normals.empty() ? 0 : part.positions.size(), none);
    for (std::size_t i = 0; i < part.indices.size(); i += 3) {
        std::array<std::uint32_t, 3> corners{part.indices[i], part.indices[i + 1],
                                             part.indices[i + 2]};
        if (determinant < 0)
            std::swap(corners[1], corners[2]);
        std::array<glm::dvec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = to_world * glm::dvec4(part.positions[corners[k]], 1.0);
        const glm::dvec3 cross = glm::cross(p[1] - p[0], p[2] - p[0]);
        const double size =
            std::max({glm::dot(p[1] - p[0], p[1] - p[0]), glm::dot(p[2] - p[0], p[2] - p[0]),
                      glm::dot(p[2] - p[1], p[2] - p[1])});
        if (!(glm::length(cross) > 1e-9 * size)) {
            ++flat_;
            continue;
        }
        ModelTriangle triangle;
        triangle.material = part.material;
        for (std::size_t k = 0; k < 3; ++k) {
            const bool shared = !made.empty();
            if (shared && made[corners[k]] != none) {
                triangle.vertices[k] = made[corners[k]];
                continue;
            }
            triangle.vertices[k] = static_cast<std::uint32_t>(model_.vertices.size());
            if (shared)
                made[corners[k]] = triangle.vertices[k];
            model_.vertices.push_back(make(corners[k], glm::normalize(cross)));
        }
        model_.triangles.push_back(triangle);
    }
    return {};
}

Result<int> ModelBuilder::add_image(const std::string& path) {
    if (const auto it = images_.find(path); it != images_.end())
        return it->second;
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_model_bytes));
    TESSERA_TRY_ASSIGN(Image image, decode_image(bytes).with_context(path));
    model_.images.push_back(std::move(image));
    return images_[path] = static_cast<int>(model_.images.size()) - 1;
}

Result<Model> ModelBuilder::finish() && {
    if (model_.triangles.empty())
        return Status(ErrorCode::invalid_file, flat_ == 0
                                                   ? std::string("has no triangles")
                                                   : "has " + std::to_string(flat_) +
                                                         " triangles, none of which has an area");
    glm::dvec3 low(1e300), high(-1e300);
    for (const ModelVertex& v : model_.vertices) {
        if (!is_sound(v.position))
            return Status(ErrorCode::invalid_file, "is too large once its nodes are in place");
        low = glm::min(low, glm::dvec3(v.position));
        high = glm::max(high, glm::dvec3(v.position));
    }
    const glm::dvec3 middle = 0.5 * (low + high);
    double radius = 0;
    for (const ModelVertex& v : model_.vertices)
        radius = std::max(radius, glm::length(glm::dvec3(v.position) - middle));
    for (ModelVertex& v : model_.vertices)
        v.position = glm::vec3((glm::dvec3(v.position) - middle) * (paper_radius / radius));
    return std::move(model_);
}

} // namespace tessera::corpus
