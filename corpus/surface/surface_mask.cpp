#include "corpus/surface/surface_source.h"

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

// How far below the surface a direction of the mirrored map may point and still count: places on round
// parts whose tap the texel is lean up to a texel's turn away from it.
constexpr double margin_round = 0.1, margin_flat = 0.02;

// A place counts as inside an object only this deep (world units): the taps around it do, too.
constexpr double hidden_depth = 0.08;

// Beyond an edge the map goes on as it folds (format/surface_mesh.h).
glm::dvec2 folded(glm::dvec2 st) {
    for (glm::length_t a = 0; a < 2; ++a)
        if (st[a] < 0.0 || st[a] > 1.0) {
            st[a] = st[a] < 0.0 ? -st[a] : 2.0 - st[a];
            st[1 - a] = 1.0 - st[1 - a];
        }
    return st;
}

// Mirrored directions that have a cell for a tap: the cell's centre and the border of what lies less
// than a cell away along s and t.
using CellRays = std::array<glm::dvec3, 9>;

std::vector<CellRays> rays_of_cells(const Texels2& directions) {
    std::vector<CellRays> cells;
    const SurfaceFrame frame{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (std::uint32_t t = 0; t < directions[1]; ++t)
        for (std::uint32_t s = 0; s < directions[0]; ++s) {
            CellRays rays;
            for (int i = 0; i < 9; ++i) {
                const glm::dvec2 st = folded(
                    {(s + 0.5 + i % 3 - 1) / directions[0], (t + 0.5 + i / 3 - 1) / directions[1]});
                const glm::dvec3 d =
                    octahedral_direction(AngularMap::octahedral_mirrored, frame, st.x, st.y);
                rays[static_cast<std::size_t>(i)] = {-d.x, -d.y, d.z}; // d mirrored at z
            }
            cells.push_back(rays);
        }
    return cells;
}

bool is_deep_inside(const Object& object, const glm::dvec3& world) {
    const glm::dvec3 p =
        object.rotated ? object.to_local * (world - object.centre) : world - object.centre;
    const glm::dvec3 half = object.half - hidden_depth;
    switch (object.shape) {
    case Shape::sphere:
        return half.x > 0.0 && glm::length(p) < half.x;
    case Shape::cylinder:
        return half.x > 0.0 && std::hypot(p.x, p.z) < half.x && std::abs(p.y) < half.y;
    case Shape::box:
        return std::abs(p.x) < half.x && std::abs(p.y) < half.y && std::abs(p.z) < half.z;
    case Shape::plane:
        return false;
    }
    return false;
}

class SurfaceMask final : public TexelSource {
public:
    SurfaceMask(std::shared_ptr<const LitSurface> surface, AngularMap map,
                const Texels2& directions)
        : surface_(std::move(surface)) {
        const Texels2& atlas = surface_->places().size();
        desc_ = {{atlas[0], atlas[1], 1, 1}, SampleType::unorm8, 1};
        if (map == AngularMap::octahedral_mirrored) {
            desc_.size[axis_s] = directions[0];
            desc_.size[axis_t] = directions[1];
            cells_ = rays_of_cells(directions);
        }
    }

    const TextureDesc& desc() const override { return desc_; }

    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        std::byte* next = out.data();
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                next = mark(u, v, box, next);
        return {};
    }

private:
    std::byte* mark(std::uint32_t u, std::uint32_t v, const Box4& box, std::byte* out) const {
        const Extent4 extent = box.extent();
        const std::size_t count = std::size_t{extent[axis_s]} * extent[axis_t];
        const bool seen = surface_->places().matters(u, v) && !is_hidden(u, v);
        if (!seen || cells_.empty()) {
            std::memset(out, seen ? 1 : 0, count);
            return out + count;
        }
        const glm::dvec3 normal = surface_->at(u, v, {0.0, 0.0}).frame.ez;
        const double least = surface_->chart_at(u, v).part.round ? -margin_round : -margin_flat;
        for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
            for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s) {
                bool above = false;
                for (const glm::dvec3& ray : cells_[std::size_t{t} * desc_.size[axis_s] + s])
                    above = above || glm::dot(ray, normal) > least;
                *out++ = static_cast<std::byte>(above);
            }
        return out;
    }

    bool is_hidden(std::uint32_t u, std::uint32_t v) const {
        const glm::dvec3 position = surface_->at(u, v, {0.0, 0.0}).light.position();
        const Object& own = surface_->object_of(surface_->chart_at(u, v));
        for (const Object& object : surface_->scene().objects)
            if (&object != &own && is_deep_inside(object, position))
                return true;
        return false;
    }

    std::shared_ptr<const LitSurface> surface_;
    TextureDesc desc_;
    std::vector<CellRays> cells_; // t slowest; empty where directions do not matter
};

} // namespace

std::unique_ptr<TexelSource> make_surface_mask(std::shared_ptr<const LitSurface> surface,
                                               AngularMap map, const Texels2& directions) {
    return std::make_unique<SurfaceMask>(std::move(surface), map, directions);
}

} // namespace tessera::corpus
