#include "corpus/model/opaque_alpha.h"
#include "corpus/model/readers.h"
#include "corpus/model/turned_vertex.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace tessera::corpus {
namespace {

constexpr float largest_coordinate = 1e15f; // squares of differences stay finite

template <class Vector> bool is_sound(const Vector& x) {
    for (glm::length_t i = 0; i < x.length(); ++i)
        if (!(std::abs(x[i]) <= largest_coordinate)) // also false for NaN
            return false;
    return true;
}

template <class Vector>
Status check_count(const ModelPart& part, const char* what, const std::vector<Vector>& values) {
    if (values.empty() || values.size() == part.positions.size())
        return {};
    return {ErrorCode::invalid_file, part.name + " has " + std::to_string(part.positions.size()) +
                                         " positions, but " + std::to_string(values.size()) +
                                         " values of " + what};
}

// Says how many values are not numbers, as exporters write them where a triangle has no area, and
// what becomes of them.
template <class Vector>
void note_unsound(const ModelPart& part, const char* what, const std::vector<Vector>& values,
                  const char* fate, std::vector<std::string>& notes) {
    if (const auto unsound =
            std::ranges::count_if(values, [](const auto& x) { return !is_sound(x); }))
        notes.push_back(part.name + ": " + std::to_string(unsound) + " of " +
                        std::to_string(values.size()) + " " + what +
                        " are not numbers, or too large; " + fate);
}

void note_unsound(const ModelPart& part, std::vector<std::string>& notes) {
    note_unsound(part, "positions", part.positions, "their triangles are left out", notes);
    note_unsound(part, "normals", part.normals, "those of triangles replace them", notes);
    note_unsound(part, "tangents", part.tangents, "they are left out", notes);
    for (const auto& uv : part.uv)
        note_unsound(part, "uv", uv, "they become 0", notes);
    note_unsound(part, "colours", part.colours, "they become white", notes);
}

Status check(const ModelPart& part) {
    TESSERA_TRY(check_count(part, "normal", part.normals));
    TESSERA_TRY(check_count(part, "tangent", part.tangents));
    TESSERA_TRY(check_count(part, "colour", part.colours));
    for (const auto& uv : part.uv)
        TESSERA_TRY(check_count(part, "uv", uv));
    if (part.indices.size() % 3 != 0)
        return {ErrorCode::invalid_file, part.name + " has " + std::to_string(part.indices.size()) +
                                             " indices, not three per triangle"};
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

struct Placement {
    glm::dmat4 to_world;
    glm::dmat3 linear{to_world}, of_normals{glm::transpose(glm::inverse(linear))};
    double determinant = glm::determinant(linear);
};

// The normal of a vertex in the file; 0 if it has none.
glm::dvec3 normal_in_file(const ModelPart& part, std::uint32_t i) {
    return part.normals.empty() || !is_sound(part.normals[i]) ? glm::dvec3(0.0)
                                                              : glm::dvec3(part.normals[i]);
}

// `face`: the normal of a triangle at the vertex, for vertices without normals.
ModelVertex placed_vertex(const ModelPart& part, std::uint32_t i, const Placement& placement,
                          const glm::dvec3& face) {
    ModelVertex v;
    v.position = glm::vec3(glm::dvec3(placement.to_world * glm::dvec4(part.positions[i], 1.0)));
    v.normal = glm::vec3(unit_or(placement.of_normals * normal_in_file(part, i), face));
    if (!part.tangents.empty() && is_sound(part.tangents[i])) {
        const glm::dvec3 t = placement.linear * glm::dvec3(part.tangents[i]);
        if (glm::length(t) > 1e-12)
            v.tangent = glm::vec4(glm::vec3(glm::normalize(t)), part.tangents[i].w < 0 ? -1 : 1);
    }
    for (std::size_t s = 0; s < 2; ++s)
        if (!part.uv[s].empty() && is_sound(part.uv[s][i]))
            v.uv[s] = part.uv[s][i];
    if (!part.colours.empty() && is_sound(part.colours[i]))
        v.colour = part.colours[i];
    return v;
}

// The unit normal of a triangle; 0 if the triangle has almost no area.
glm::dvec3 normal_or_zero(const std::array<glm::dvec3, 3>& p) {
    const glm::dvec3 a = p[1] - p[0], b = p[2] - p[0], c = p[2] - p[1];
    const glm::dvec3 cross = glm::cross(a, b);
    const double longest = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
    return glm::length(cross) > 1e-9 * longest ? glm::normalize(cross) : glm::dvec3(0.0);
}

// Whether the file's normals at all corners point to the back of a triangle, as where a tool turned
// faces alone. No light would reach such a triangle.
bool has_normals_behind(const ModelPart& part, const std::array<std::uint32_t, 3>& corners,
                        const Placement& placement, const glm::dvec3& face) {
    return !part.normals.empty() && std::ranges::all_of(corners, [&](std::uint32_t i) {
        return glm::dot(placement.of_normals * normal_in_file(part, i), face) < 0.0;
    });
}

} // namespace

Status ModelBuilder::add(const ModelPart& part, const glm::dmat4& to_world) {
    TESSERA_TRY(check(part));
    if (model_.triangles.size() + part.indices.size() / 3 > most_triangles)
        return {ErrorCode::unsupported,
                part.name + ": more than " + std::to_string(most_triangles) + " triangles in all"};
    note_unsound(part, model_.notes);
    const Placement placement{to_world};
    if (!(std::abs(placement.determinant) > 1e-30) || !(std::abs(placement.determinant) < 1e30))
        return {ErrorCode::invalid_file,
                part.name + " has a transform whose determinant is 0 or too large"};
    constexpr std::uint32_t none = UINT32_MAX;
    // Of vertices in the model, and of those with turned normals.
    std::vector<std::uint32_t> numbers(part.positions.size(), none), turned;
    for (std::size_t i = 0; i < part.indices.size(); i += 3) {
        std::array<std::uint32_t, 3> corners{part.indices[i], part.indices[i + 1],
                                             part.indices[i + 2]};
        if (placement.determinant < 0)
            std::swap(corners[1], corners[2]);
        std::array<glm::dvec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = to_world * glm::dvec4(part.positions[corners[k]], 1.0);
        if (!std::ranges::all_of(corners, [&](auto k) { return is_sound(part.positions[k]); })) {
            ++nowhere_;
            continue;
        }
        const glm::dvec3 normal = normal_or_zero(p);
        if (normal == glm::dvec3(0.0)) {
            ++flat_;
            continue;
        }
        ModelTriangle triangle{.vertices = {}, .material = part.material};
        const bool turns = has_normals_behind(part, corners, placement, normal);
        if (turns)
            turned.resize(part.positions.size(), none);
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint32_t& number = (turns ? turned : numbers)[corners[k]];
            // Triangles without normals in the file share no vertices.
            if (number == none || part.normals.empty()) {
                number = static_cast<std::uint32_t>(model_.vertices.size());
                ModelVertex v = placed_vertex(part, corners[k], placement, normal);
                model_.vertices.push_back(turns ? turned_vertex(v) : v);
            }
            triangle.vertices[k] = number;
        }
        model_.triangles.push_back(triangle);
    }
    return {};
}

int ModelBuilder::add_image_or_note(const std::string& path) {
    if (const auto it = images_.find(path); it != images_.end())
        return it->second;
    const auto read = [&]() -> Result<Image> {
        TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_model_bytes));
        return decode_image(bytes).with_context(path);
    };
    Result<Image> image = read();
    if (!image.ok()) {
        model_.notes.push_back(image.status().message() + "; materials are read without it");
        return images_[path] = -1;
    }
    model_.images.push_back(std::move(*image));
    return images_[path] = static_cast<int>(model_.images.size()) - 1;
}

Result<Model> ModelBuilder::finish() && {
    if (model_.triangles.empty())
        return Status(ErrorCode::invalid_file,
                      nowhere_ > 0 ? "has " + std::to_string(nowhere_ + flat_) +
                                         " triangles, whose positions are no numbers or which have "
                                         "no area"
                      : flat_ > 0
                          ? "has " + std::to_string(flat_) + " triangles, none of which has an area"
                          : std::string("has no triangles"));
    glm::dvec3 low(1e300), high(-1e300);
    for (const ModelVertex& v : model_.vertices) {
        if (!is_sound(v.position))
            return Status(ErrorCode::invalid_file, "is too large after its transforms");
        low = glm::min(low, glm::dvec3(v.position));
        high = glm::max(high, glm::dvec3(v.position));
    }
    ignore_opaque_alpha(model_);
    const glm::dvec3 middle = 0.5 * (low + high);
    double radius = 0;
    for (const ModelVertex& v : model_.vertices)
        radius = std::max(radius, glm::length(glm::dvec3(v.position) - middle));
    const double scale = paper_radius / radius;
    model_.frame = {middle, scale};
    for (ModelVertex& v : model_.vertices)
        v.position = glm::vec3(model_.frame.from_file(glm::dvec3(v.position)));
    for (ModelMaterial& material : model_.materials)
        if (material.coats)
            material.coats->attenuation_distance *= scale;
    for (ModelCamera& camera : model_.cameras)
        camera.eye = model_.frame.from_file(camera.eye);
    for (ModelLamp& lamp : model_.lamps) {
        lamp.position = model_.frame.from_file(lamp.position);
        lamp.range *= scale;
        if (lamp.kind != ModelLamp::Kind::directional)
            lamp.strength *= scale * scale; // the same irradiance
    }
    return std::move(model_);
}

} // namespace tessera::corpus
