#include "corpus/model_surface/model_source.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace tessera::corpus {
namespace {

// How far below the surface a direction of the mirrored map may point and still count: places whose
// tap the texel is lean away from it.
constexpr double margin = 0.15;

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

// Beyond an edge the map goes on as it folds (format/surface_mesh.h).
glm::dvec2 folded_back(glm::dvec2 st) {
    for (glm::length_t a = 0; a < 2; ++a)
        if (st[a] < 0.0 || st[a] > 1.0) {
            st[a] = st[a] < 0.0 ? -st[a] : 2.0 - st[a];
            st[1 - a] = 1.0 - st[1 - a];
        }
    return st;
}

class ModelMask final : public TexelSource {
public:
    ModelMask(std::shared_ptr<const LitModel> model, AngularMap map, const Texels2& directions)
        : model_(std::move(model)) {
        const Texels2& atlas = model_->places().size();
        desc_ = {{atlas[0], atlas[1], 1, 1}, SampleType::unorm8, 1};
        if (map != AngularMap::octahedral_mirrored)
            return;
        desc_.size[axis_s] = directions[0];
        desc_.size[axis_t] = directions[1];
        const SurfaceFrame frame{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        for (std::uint32_t t = 0; t < directions[1]; ++t)
            for (std::uint32_t s = 0; s < directions[0]; ++s)
                for (int i = 0; i < 9; ++i) {
                    const glm::dvec2 st = folded_back({(s + 0.5 + i % 3 - 1) / directions[0],
                                                       (t + 0.5 + i / 3 - 1) / directions[1]});
                    const glm::dvec3 d = octahedral_direction(map, frame, st.x, st.y);
                    rays_.push_back({-d.x, -d.y, d.z}); // mirrored at z
                }
    }

    const TextureDesc& desc() const override { return desc_; }

    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        std::byte* next = out.data();
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u) {
                const bool matters = model_->matters(u, v);
                const glm::dvec3 normal =
                    matters && !rays_.empty() ? model_->frame(u, v).ez : glm::dvec3(0.0);
                for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
                    for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s)
                        *next++ = static_cast<std::byte>(matters && is_seen(s, t, normal));
            }
        return {};
    }

private:
    bool is_seen(std::uint32_t s, std::uint32_t t, const glm::dvec3& normal) const {
        if (rays_.empty())
            return true;
        const auto first = rays_.begin() + static_cast<std::ptrdiff_t>(
                                               9 * (std::size_t{t} * desc_.size[axis_s] + s));
        return std::any_of(first, first + 9,
                           [&](const glm::dvec3& ray) { return glm::dot(ray, normal) > -margin; });
    }

    std::shared_ptr<const LitModel> model_;
    TextureDesc desc_;
    std::vector<glm::dvec3> rays_; // nine a cell: its centre and around it; t slowest
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
    return std::make_unique<ModelMask>(std::move(model), map, directions);
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
        // Cells that nobody sees do not count.
        const SurfaceFrame frame = model.frame(u, v);
        if (glm::dot(octahedral_direction(map, frame, x, y), frame.ez) < 0.0)
            continue;
        const glm::dvec3 way = display.value(model.other_light(u, v, map, x, y, 2 * i + 11)) -
                               display.value(model.other_light(u, v, map, x, y, 2 * i + 12));
        squares +=
            glm::dot(way, way) / 6.0; // three channels; the difference has twice the variance
        ++done;
    }
    NoiseEstimate estimate;
    estimate.samples = samples;
    estimate.decibels = done == 0 || squares == 0.0 ? std::numeric_limits<double>::infinity()
                                                    : -10.0 * std::log10(squares / done);
    return estimate;
}

} // namespace tessera::corpus
