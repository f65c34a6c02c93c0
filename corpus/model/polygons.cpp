#include "corpus/model/polygons.h"

#include "corpus/pattern.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <unordered_map>

namespace tessera::corpus {
namespace {

constexpr double crease_cosine = 0.70710678118654752;
// Where more corners meet, polygons keep their own normals, because the time for averaging grows
// with the square of the number.
constexpr std::size_t most_averaged = 256;
// The most steps of triangulation in one model; they take some seconds.
constexpr std::uint64_t most_steps = std::uint64_t{1} << 31;

// The polygon's normal (Newell's formula). Its length is twice the area.
glm::dvec3 doubled_area(const PolygonModel& model, std::span<const PolygonCorner> polygon) {
    glm::dvec3 sum{0.0};
    const glm::dvec3 origin(model.positions[polygon[0].position]);
    for (std::size_t i = 2; i < polygon.size(); ++i)
        sum += glm::cross(glm::dvec3(model.positions[polygon[i - 1].position]) - origin,
                          glm::dvec3(model.positions[polygon[i].position]) - origin);
    return sum;
}

// Cuts a counter-clockwise polygon in the plane into triangles, one ear after another. An ear is a
// convex corner whose triangle contains no other corner.
class EarCutter {
public:
    EarCutter(std::vector<glm::dvec2> corners, std::uint64_t& steps)
        : p_(std::move(corners)), steps_(steps) {
        const auto n = static_cast<std::uint32_t>(p_.size());
        for (std::uint32_t i = 0; i < n; ++i) {
            before_.push_back(i == 0 ? n - 1 : i - 1);
            after_.push_back(i + 1 == n ? 0 : i + 1);
        }
        for (std::uint32_t i = 0; i < n; ++i)
            if (turn(before_[i], i, after_[i]) < 0.0)
                reflex_.push_back(i);
    }

    // Calls cut(a, b, c) for every triangle. Returns false after too many steps.
    template <class Cut> bool run(const Cut& cut) {
        if (steps_ + p_.size() * reflex_.size() > most_steps)
            return false;
        std::size_t left = p_.size(), missed = 0;
        std::uint32_t i = 1; // a convex polygon becomes a fan around corner 0
        while (left > 2) {
            const std::uint32_t a = before_[i], c = after_[i];
            // A polygon that crosses itself may have no ear: then cut any corner.
            if (missed < left && !is_ear(a, i, c)) {
                ++missed;
                i = c;
                continue;
            }
            if (steps_ > most_steps)
                return false;
            cut(a, i, c);
            after_[a] = c;
            before_[c] = a;
            std::erase(reflex_, i);
            missed = 0;
            i = c;
            --left;
        }
        return true;
    }

private:
    double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
        const glm::dvec2 p = p_[b] - p_[a], q = p_[c] - p_[b];
        return p.x * q.y - p.y * q.x;
    }

    bool is_ear(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        ++steps_;
        if (turn(a, b, c) <= 0.0)
            return false;
        return std::ranges::none_of(reflex_, [&](std::uint32_t r) {
            ++steps_;
            return p_[r] != p_[a] && p_[r] != p_[b] && p_[r] != p_[c] && turn(a, b, r) >= 0.0 &&
                   turn(b, c, r) >= 0.0 && turn(c, a, r) >= 0.0;
        });
    }

    std::vector<glm::dvec2> p_;
    std::vector<std::uint32_t> before_, after_, reflex_; // indices of corners
    std::uint64_t& steps_;
};

class PartMaker {
public:
    PartMaker(const PolygonModel& model, const PolygonMesh& mesh, std::uint64_t& steps)
        : model_(model), mesh_(mesh), steps_(steps) {}

    Result<ModelPart> run(const std::string& name) {
        part_.name = name;
        part_.material = mesh_.material;
        TESSERA_TRY(check_positions());
        find_normals();
        std::size_t first = 0;
        for (const std::uint32_t size : mesh_.sizes) {
            if (size > 2 && !triangulate(first, size))
                return Status(ErrorCode::unsupported,
                              name + ": its polygons have too many corners to be triangulated");
            first += size;
        }
        return std::move(part_);
    }

private:
    std::span<const PolygonCorner> polygon(std::size_t first, std::size_t size) const {
        return std::span(mesh_.corners).subspan(first, size);
    }

    Status check_positions() const {
        std::size_t corner = 0;
        for (std::size_t i = 0; i < mesh_.sizes.size(); ++i)
            for (std::uint32_t k = 0; k < mesh_.sizes[i]; ++k, ++corner)
                if (const std::uint32_t p = mesh_.corners[corner].position;
                    p >= model_.positions.size())
                    return {ErrorCode::invalid_file,
                            part_.name + ": face " + std::to_string(i) + " has vertex " +
                                (p == absent ? "-1" : std::to_string(p)) + " of " +
                                std::to_string(model_.positions.size())};
        return {};
    }

    // Sets the normal of every corner: that of the file or the mean of polygons.
    void find_normals() {
        std::vector<glm::dvec3> areas; // of the polygon of each corner
        std::size_t first = 0;
        for (const std::uint32_t size : mesh_.sizes) {
            const glm::dvec3 area =
                size > 2 ? doubled_area(model_, polygon(first, size)) : glm::dvec3(0.0);
            areas.insert(areas.end(), size, area);
            first += size;
        }
        std::vector<std::uint32_t> order(mesh_.corners.size());
        std::iota(order.begin(), order.end(), 0u);
        // Compares bits, because NaN has no order. Adding 0 turns -0 into 0.
        const auto place = [&](std::uint32_t corner) {
            return std::bit_cast<std::array<std::uint32_t, 3>>(
                model_.positions[mesh_.corners[corner].position] + 0.0f);
        };
        std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(place(i), i); });
        normals_.assign(order.size(), glm::vec3(0.0f));
        for (auto begin = order.begin(); begin != order.end();) {
            const auto end = std::find_if(
                begin, order.end(), [&](std::uint32_t i) { return place(i) != place(*begin); });
            for (auto i = begin; i != end; ++i)
                if (const std::uint32_t n = mesh_.corners[*i].normal; n < model_.normals.size())
                    normals_[*i] = model_.normals[n];
                else
                    normals_[*i] = mean_normal(areas, areas[*i], std::span(begin, end));
            begin = end;
        }
    }

    static glm::vec3 mean_normal(const std::vector<glm::dvec3>& areas, const glm::dvec3& own,
                                 std::span<const std::uint32_t> corners) {
        glm::dvec3 sum{0.0};
        if (corners.size() > most_averaged)
            sum = own;
        else
            for (const std::uint32_t i : corners)
                if (glm::dot(areas[i], own) >=
                    crease_cosine * glm::length(areas[i]) * glm::length(own))
                    sum += areas[i];
        const double length = glm::length(sum);
        return length > 0.0 ? glm::vec3(sum / length) : glm::vec3(0.0f);
    }

    // Returns false after too many steps. Ignores polygons without area.
    bool triangulate(std::size_t first, std::size_t size) {
        const auto corners = polygon(first, size);
        const auto cut = [&](auto a, auto b, auto c) {
            for (const std::uint32_t k : {a, b, c})
                part_.indices.push_back(vertex_of(first + k));
        };
        if (size == 3) {
            cut(0u, 1u, 2u);
            return true;
        }
        // Projected along the axis that is closest to the normal.
        const glm::dvec3 n = doubled_area(model_, corners);
        if (n == glm::dvec3(0.0))
            return true;
        const glm::dvec3 m = glm::abs(n);
        const glm::length_t axis = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
        const glm::length_t x = (axis + (n[axis] < 0.0 ? 2 : 1)) % 3, y = 3 - axis - x;
        std::vector<glm::dvec2> flat;
        for (const PolygonCorner& c : corners)
            flat.emplace_back(model_.positions[c.position][x], model_.positions[c.position][y]);
        return EarCutter(std::move(flat), steps_).run(cut);
    }

    // Corners with the same position, uv and normal share a vertex.
    std::uint32_t vertex_of(std::size_t corner) {
        const PolygonCorner& c = mesh_.corners[corner];
        const glm::vec2 uv = c.uv < model_.uv.size() ? model_.uv[c.uv] : glm::vec2(0.0f);
        const glm::vec3& n = normals_[corner];
        const Key key{c.position,
                      std::bit_cast<std::uint32_t>(uv.x),
                      std::bit_cast<std::uint32_t>(uv.y),
                      std::bit_cast<std::uint32_t>(n.x),
                      std::bit_cast<std::uint32_t>(n.y),
                      std::bit_cast<std::uint32_t>(n.z)};
        const auto [it, is_new] =
            vertices_.emplace(key, static_cast<std::uint32_t>(part_.positions.size()));
        if (is_new) {
            part_.positions.push_back(model_.positions[c.position]);
            part_.normals.push_back(n);
            if (!model_.uv.empty())
                part_.uv[0].push_back(uv);
            if (!model_.colours.empty())
                part_.colours.push_back(model_.colours[c.position]);
        }
        return it->second;
    }

    using Key = std::array<std::uint32_t, 6>;
    struct Hash {
        std::size_t operator()(const Key& key) const {
            std::uint64_t hash = 0;
            for (const std::uint32_t part : key)
                hash = mix_bits(hash + part);
            return hash;
        }
    };

    const PolygonModel& model_;
    const PolygonMesh& mesh_;
    std::uint64_t& steps_;
    ModelPart part_;
    std::vector<glm::vec3> normals_; // of each corner
    std::unordered_map<Key, std::uint32_t, Hash> vertices_;
};

} // namespace

void PolygonMesh::add(std::span<const PolygonCorner> polygon) {
    sizes.push_back(static_cast<std::uint32_t>(polygon.size()));
    corners.insert(corners.end(), polygon.begin(), polygon.end());
}

Status add_polygons(const PolygonModel& model, ModelBuilder& builder) {
    std::uint64_t steps = 0;
    bool any = false;
    for (std::size_t i = 0; i < model.meshes.size(); ++i) {
        const PolygonMesh& mesh = model.meshes[i];
        any = any || !mesh.sizes.empty();
        TESSERA_TRY_ASSIGN(const ModelPart part,
                           PartMaker(model, mesh, steps).run("mesh " + std::to_string(i)));
        TESSERA_TRY(builder.add(part, glm::dmat4(1.0)));
    }
    if (!any && !model.positions.empty())
        return {ErrorCode::unsupported, "is a point cloud, not a mesh: it has no faces"};
    return {};
}

glm::dvec3 linear_colour(const glm::dvec3& displayed) {
    glm::dvec3 linear;
    for (glm::length_t c = 0; c < 3; ++c)
        linear[c] = srgb_to_linear(std::clamp(displayed[c], 0.0, 1.0));
    return linear;
}

ModelMaterial plain_material(const glm::dvec3& displayed, double exponent) {
    ModelMaterial m;
    m.base = glm::dvec4(linear_colour(displayed), 1.0);
    m.metal = 0.0;
    m.roughness = 0.5;
    // Phong's lobe is about as wide as that of GGX with alpha^2 = 2 / (exponent + 2).
    if (exponent > 0.0)
        m.roughness = std::clamp(std::sqrt(std::sqrt(2.0 / (exponent + 2.0))), 0.05, 1.0);
    return m;
}

} // namespace tessera::corpus
