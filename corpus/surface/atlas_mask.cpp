#include "corpus/surface/atlas_mask.h"

#include "format/surface_mesh.h"

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

// Beyond its edges the map continues folded (format/surface_mesh.h).
glm::dvec2 folded(glm::dvec2 st) {
    for (glm::length_t a = 0; a < 2; ++a)
        if (st[a] < 0.0 || st[a] > 1.0) {
            st[a] = st[a] < 0.0 ? -st[a] : 2.0 - st[a];
            st[1 - a] = 1.0 - st[1 - a];
        }
    return st;
}

// The mirrored directions for which a cell is a tap: the cell's centre, and the border of the
// square that lies less than one cell away along s and t.
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

class AtlasMask final : public TexelSource {
public:
    AtlasMask(MaskTexels texels, AngularMap map, const Texels2& directions)
        : texels_(std::move(texels)) {
        desc_ = {{texels_.size[0], texels_.size[1], 1, 1}, SampleType::unorm8, 1};
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
        const bool visible = texels_.is_visible(u, v);
        if (!visible || cells_.empty()) {
            std::memset(out, visible ? 1 : 0, count);
            return out + count;
        }
        const MaskFront front = texels_.front(u, v);
        for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
            for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s)
                *out++ = static_cast<std::byte>(std::ranges::any_of(
                    cells_[std::size_t{t} * desc_.size[axis_s] + s], [&](const glm::dvec3& ray) {
                        return glm::dot(ray, front.normal) > -front.margin;
                    }));
        return out;
    }

    MaskTexels texels_;
    TextureDesc desc_;
    std::vector<CellRays> cells_; // t slowest; empty if directions do not matter
};

} // namespace

std::unique_ptr<TexelSource> make_atlas_mask(MaskTexels texels, AngularMap map,
                                             const Texels2& directions) {
    return std::make_unique<AtlasMask>(std::move(texels), map, directions);
}

} // namespace tessera::corpus
