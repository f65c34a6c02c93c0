#include "corpus/surface/surface_source.h"

#include "corpus/bake.h" // max_samples_per_texel
#include "corpus/surface/spread_offsets.h"
#include "corpus/texel_bytes.h"

#include <cstring>

namespace tessera::corpus {
namespace {

class SurfaceTexels final : public TexelSource {
public:
    SurfaceTexels(std::shared_ptr<const LitSurface> surface, AngularMap map,
                  const TextureDesc& desc, unsigned samples)
        : surface_(std::move(surface)), map_(map), desc_(desc), offsets_(spread_offsets(samples)),
          empty_(to_bytes(surface_->scene().background, desc.type)) {}

    const TextureDesc& desc() const override { return desc_; }
    bool cheap_to_reread() const override { return false; }

    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        std::byte* next = out.data();
        std::vector<LitSurface::Place> places;
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                next = bake(u, v, box, places, next);
        return {};
    }

private:
    std::byte* fill(const TexelBytes& texel, const Box4& box, std::byte* out) const {
        const Extent4 extent = box.extent();
        for (std::uint32_t i = 0; i < extent[axis_s] * extent[axis_t]; ++i)
            out = put(texel, out);
        return out;
    }
    std::byte* put(const TexelBytes& texel, std::byte* out) const {
        std::memcpy(out, texel.data(), desc_.texel_bytes());
        return out + desc_.texel_bytes();
    }

    std::byte* bake(std::uint32_t u, std::uint32_t v, const Box4& box,
                    std::vector<LitSurface::Place>& places, std::byte* out) const {
        if (!surface_->places().matters(u, v))
            return fill(empty_, box, out);
        places.clear();
        for (const glm::dvec2& offset : offsets_)
            places.push_back(surface_->at(u, v, offset));
        const auto texel = [&](const auto& direction) {
            glm::dvec3 sum{0.0};
            for (const LitSurface::Place& place : places)
                sum += place.light.leaving(direction(place));
            return to_bytes(sum / static_cast<double>(places.size()), desc_.type);
        };
        if (!shines(surface_->object_of(surface_->chart_at(u, v)).material))
            return fill(texel([](const LitSurface::Place& p) { return p.light.normal(); }), box,
                        out);
        for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
            for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s)
                out = put(texel([&](const LitSurface::Place& p) {
                              return octahedral_direction(map_, p.frame,
                                                          (s + 0.5) / desc_.size[axis_s],
                                                          (t + 0.5) / desc_.size[axis_t]);
                          }),
                          out);
        return out;
    }

    std::shared_ptr<const LitSurface> surface_;
    AngularMap map_;
    TextureDesc desc_;
    std::vector<glm::dvec2> offsets_;
    TexelBytes empty_;
};

} // namespace

Result<std::unique_ptr<TexelSource>> make_surface_source(std::shared_ptr<const LitSurface> surface,
                                                         AngularMap map, const Texels2& directions,
                                                         unsigned samples) {
    if (samples == 0 || samples > max_samples_per_texel)
        return Status{ErrorCode::bad_argument, std::to_string(samples) +
                                                   " samples per texel, outside 1.." +
                                                   std::to_string(max_samples_per_texel)};
    const Texels2& atlas = surface->places().size();
    const TextureDesc desc{
        {atlas[0], atlas[1], directions[0], directions[1]}, surface->scene().type, 3};
    TESSERA_TRY(check_desc(desc));
    return std::unique_ptr<TexelSource>(
        std::make_unique<SurfaceTexels>(std::move(surface), map, desc, samples));
}

} // namespace tessera::corpus
