#include "corpus/model_surface/model_angular_choice.h"

#include "corpus/surface/angular_choice.h"

namespace tessera::corpus {
namespace {

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
    // The nearest texel; the texel itself where that is of another chart.
    Place at(std::size_t texel, const glm::dvec2& offset) const override {
        const auto [u, v] = moved(texels_[texel], offset);
        const SurfaceFrame frame = model_.frame(u, v);
        return {frame, [this, u = u, v = v, frame,
                        arriving = model_.arriving(u, v)](const glm::dvec3& towards) {
                    constexpr AngularMap map = AngularMap::octahedral_hemisphere; // any
                    const glm::dvec3 d =
                        towards - 2.0 * std::min(glm::dot(towards, frame.ez), 0.0) * frame.ez;
                    const glm::dvec2 st = octahedral_place(map, frame, d);
                    return display_.value(model_.light(u, v, map, st.x, st.y, *arriving));
                }};
    }
    // Each takes hundreds of paths.
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

AngularMap choose_angular_map(const LitModel& model, const Display& display,
                              const Texels2& directions) {
    return choose_angular_map(TrialTexels(model, display), directions);
}

} // namespace tessera::corpus
