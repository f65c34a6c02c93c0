#include "corpus/model_surface/model_source.h"

#include "corpus/surface/angular_choice.h"
#include "corpus/surface/atlas_mask.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace tessera::corpus {
namespace {

constexpr double mask_margin = 0.15; // MaskFront::margin

class ModelTexels final : public TexelSource {
public:
    ModelTexels(std::shared_ptr<const LitModel> model, AngularMap map, const TextureDesc& desc,
                const Display& display)
        : model_(std::move(model)), map_(map), desc_(desc), display_(display) {}

    const TextureDesc& desc() const override { return desc_; }
    bool cheap_to_reread() const override { return false; }

    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        std::byte* next = out.data();
        const std::size_t bytes = desc_.texel_bytes();
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u) {
                const auto arriving = model_->matters(u, v) ? model_->arriving(u, v) : nullptr;
                for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
                    for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s) {
                        const TexelBytes texel = bake(u, v, s, t, arriving.get());
                        std::memcpy(next, texel.data(), bytes);
                        next += bytes;
                    }
            }
        return {};
    }

private:
    TexelBytes bake(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t,
                    const LitModel::Arriving* arriving) const {
        if (arriving == nullptr)
            return to_bytes(glm::dvec3(0.0), desc_.type);
        const glm::dvec3 light = model_->light(u, v, map_, (s + 0.5) / desc_.size[axis_s],
                                               (t + 0.5) / desc_.size[axis_t], *arriving);
        return to_bytes(display_.value(light), desc_.type);
    }

    std::shared_ptr<const LitModel> model_;
    AngularMap map_;
    TextureDesc desc_;
    Display display_;
};

class TrialTexels final : public TrialSurface {
public:
    TrialTexels(const LitModel& model, const Display& display) : model_(model), display_(display) {
        const Texels2& size = model.places().size();
        for (std::uint32_t v = 0; v < size[1]; ++v)
            for (std::uint32_t u = 0; u < size[0]; ++u)
                if (model.matters(u, v))
                    texels_.push_back({u, v});
    }
    std::size_t texels() const override { return texels_.size(); }
    // The nearest texel, or the texel itself if that one belongs to another chart.
    Place at(std::size_t texel, const glm::dvec2& offset) const override {
        const auto [u, v] = moved(texels_[texel], offset);
        const SurfaceFrame frame = model_.frame(u, v);
        return {frame, [this, u = u, v = v, frame,
                        arriving = model_.arriving(u, v)](const glm::dvec3& towards) {
                    constexpr AngularMap map = AngularMap::octahedral_hemisphere; // any map will do
                    const glm::dvec3 d =
                        towards - 2.0 * std::min(glm::dot(towards, frame.ez), 0.0) * frame.ez;
                    const glm::dvec2 st = octahedral_place(map, frame, d);
                    return display_.value(model_.light(u, v, map, st.x, st.y, *arriving));
                }};
    }
    // Few, because each takes hundreds of paths.
    unsigned trials() const override { return 256; }

private:
    Texels2 moved(const Texels2& texel, const glm::dvec2& offset) const {
        Texels2 there = texel;
        for (std::size_t a = 0; a < 2; ++a) {
            const double x = texel[a] + std::round(offset[static_cast<glm::length_t>(a)]);
            if (x < 0.0 || x >= model_.places().size()[a])
                return texel;
            there[a] = static_cast<std::uint32_t>(x);
        }
        const auto chart = [&](const Texels2& at) {
            return model_.places().chart_of(
                model_.places().place(at[0], at[1], {0.0, 0.0}).triangle);
        };
        return model_.matters(there[0], there[1]) && chart(there) == chart(texel) ? there : texel;
    }

    const LitModel& model_;
    const Display& display_;
    std::vector<Texels2> texels_;
};

} // namespace

Result<std::unique_ptr<TexelSource>> make_model_source(std::shared_ptr<const LitModel> model,
                                                       AngularMap map, const Texels2& directions,
                                                       const Display& display) {
    const Texels2& atlas = model->places().size();
    const TextureDesc desc{{atlas[0], atlas[1], directions[0], directions[1]}, display.type, 3};
    TESSERA_TRY(check_desc(desc));
    return std::unique_ptr<TexelSource>(
        std::make_unique<ModelTexels>(std::move(model), map, desc, display));
}

std::unique_ptr<TexelSource> make_model_mask(std::shared_ptr<const LitModel> model, AngularMap map,
                                             const Texels2& directions) {
    return make_atlas_mask(
        {.size = model->places().size(),
         .is_visible = [model](std::uint32_t u, std::uint32_t v) { return model->matters(u, v); },
         .front =
             [model](std::uint32_t u, std::uint32_t v) {
                 return MaskFront{model->frame(u, v).ez, mask_margin};
             }},
        map, directions);
}

AngularMap choose_angular_map(const LitModel& model, const Display& display,
                              const Texels2& directions) {
    return choose_angular_map(TrialTexels(model, display), directions);
}

double NoiseEstimate::samples_for(double wanted) const {
    return std::ceil(samples * std::max(1.0, std::pow(10.0, (wanted - decibels) / 10.0)));
}

NoiseEstimate estimate_noise(const LitModel& model, AngularMap map, const Texels2& directions,
                             const Display& display, unsigned samples, unsigned trials) {
    const Texels2& size = model.places().size();
    double squares = 0;
    unsigned done = 0;
    for (std::uint64_t i = 0; done < trials && i < std::uint64_t{trials} * 64; ++i) {
        const std::uint64_t dice = mix_bits(i + 1), more = mix_bits(dice);
        const auto u = static_cast<std::uint32_t>((dice & 0xFFFFFFFFu) * size[0] >> 32);
        const auto v = static_cast<std::uint32_t>((dice >> 32) * size[1] >> 32);
        if (!model.matters(u, v))
            continue;
        const auto s = static_cast<std::uint32_t>((more & 0xFFFFFFFFu) * directions[0] >> 32);
        const auto t = static_cast<std::uint32_t>((more >> 32) * directions[1] >> 32);
        const double x = (s + 0.5) / directions[0], y = (t + 0.5) / directions[1];
        // Skip cells that no observer sees.
        const SurfaceFrame frame = model.frame(u, v);
        if (glm::dot(octahedral_direction(map, frame, x, y), frame.ez) < 0.0)
            continue;
        const glm::dvec3 way = display.value(model.other_light(u, v, map, x, y, 2 * i + 11)) -
                               display.value(model.other_light(u, v, map, x, y, 2 * i + 12));
        // Three channels, and the variance of a difference is twice that of a value.
        squares += glm::dot(way, way) / 6.0;
        ++done;
    }
    return {.decibels = done == 0 || squares == 0.0 ? std::numeric_limits<double>::infinity()
                                                    : -10.0 * std::log10(squares / done),
            .samples = samples};
}

} // namespace tessera::corpus
