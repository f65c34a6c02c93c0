#include "corpus/fit/view_fit.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

constexpr double most_view_samples = 3e6; // of a fit

enum ViewPart : std::size_t { places, cells, texels };

// The sum of a colour per place, of differences of cells of places by direction, and of differences
// of each place. Cells are what lets conjugate gradients find broad changes in few steps.
class ViewFields final : public FittedFields {
public:
    // make(width, height, directions) makes a field on the surface.
    template <class Make>
    ViewFields(const std::array<std::uint32_t, 2>& size,
               const std::array<std::uint32_t, 2>& directions, const Make& make) {
        constexpr std::uint32_t cell = 8; // places along a side
        const auto count = [](std::uint32_t n) { return std::max(2u, (n + cell / 2) / cell); };
        fields.push_back(make(size[0], size[1], std::array{1u, 1u}));
        fields.push_back(make(count(size[0]), count(size[1]), directions));
        fields.push_back(make(size[0], size[1], directions));
        most_samples = most_pixels = most_view_samples;
        least_rays = most_rays = 1;
    }

    void set_costs(const PhotoSamples& samples, double smoothness) override {
        const auto seen = [&](ViewPart part) { return seen_weight(fields[part], samples); };
        fields[places].smooth_places = 0.1 * seen(places);
        fields[places].shrink = 1e-5 * seen(places);
        fields[cells].smooth_places = 0.1 * smoothness * seen(cells);
        fields[cells].smooth_directions = 0.2 * smoothness * seen(cells);
        fields[cells].shrink = 1e-4 * seen(cells);
        fields[texels].smooth_places = 0.2 * smoothness * seen(texels);
        fields[texels].smooth_directions = 0.2 * smoothness * seen(texels);
        fields[texels].shrink = 0.02 * smoothness * seen(texels);
    }
};

std::byte code_of(float value) {
    return static_cast<std::byte>(
        static_cast<unsigned>(255.0f * std::clamp(value, 0.0f, 1.0f) + 0.5f));
}

// Adds up the fields in the texels of the finest one.
Status add_up(const ViewFields& fitted, const BakeRun& run, ViewFit& out) {
    const TextureField& finest = fitted.fields[texels];
    const std::size_t per_place = finest.texels_per_place();
    const Extent4 size{finest.width, finest.height, finest.directions[0], finest.directions[1]};
    out.desc = {size, SampleType::unorm8, 3};
    out.texels.resize(out.desc.box_bytes(Box4::whole(size)));
    out.mask_desc = {size, SampleType::unorm8, 1};
    out.mask.resize(texel_count(size));
    for (std::size_t i = 0; i < out.mask.size(); ++i)
        out.mask[i] = std::byte{fitted.seen[texels][i]};
    return for_rows("adding up", finest.height, run, [&](std::uint32_t row) {
        const std::size_t begin = std::size_t{row} * finest.width * per_place;
        for (std::size_t i = begin; i < begin + finest.width * per_place; ++i) {
            const PhotoSample centre = centre_of_texel(finest, i);
            std::array<float, 3> sum{finest.values[3 * i], finest.values[3 * i + 1],
                                     finest.values[3 * i + 2]};
            for (const ViewPart part : {places, cells}) {
                const TextureField& field = fitted.fields[part];
                const FieldTaps seen = taps(field, centre);
                for (unsigned j = 0; j < seen.count; ++j)
                    for (std::size_t c = 0; c < 3; ++c)
                        sum[c] += seen.weight[j] * field.values[seen.first[j] + c];
            }
            for (std::size_t c = 0; c < 3; ++c)
                out.texels[3 * i + c] = code_of(sum[c]);
        }
    });
}

Status check_views(const ViewFitOptions& o) {
    if (!(o.most_texels >= 1024.0 && o.most_texels <= 1e8) || o.directions > 64 ||
        !(o.focus >= 0.0))
        return {ErrorCode::bad_argument,
                "texels are 1024 to 10^8, there are at most 64 directions along an axis, and the "
                "focus is at least 0"};
    return {};
}

Result<ViewFit> fit_views(const SeenSurface& surface, ViewFields& fitted,
                          std::span<const PosedPhotograph> photographs,
                          const ViewFitOptions& options) {
    ViewFit out;
    TESSERA_TRY_ASSIGN(static_cast<PhotoFindings&>(out),
                       solve_photographs(surface, fitted, photographs, options));
    TESSERA_TRY(add_up(fitted, options.run, out));
    return out;
}

// A field on the sphere, for ViewFields.
auto sphere_maker(double focus) {
    return [focus](std::uint32_t width, std::uint32_t height,
                   const std::array<std::uint32_t, 2>& directions) {
        return make_sphere_field(width, height, directions, focus);
    };
}

constexpr double coarse_texels = 1e5, coarse_samples = 1e5; // of trials

// The share of the radius, with which coarse fits predict photographs best.
Result<double> choose_share(const PhotoSphere& sphere, std::uint32_t n,
                            std::span<const PosedPhotograph> photographs,
                            const ViewFitOptions& given) {
    ViewFitOptions options = given;
    options.smoothness = 1;
    options.iterations = 20;
    const std::uint32_t width = width_on(sphere, photographs, n, coarse_texels);
    double best = 1, least = 0;
    for (const double share : {1.0, 0.8, 0.6, 0.4, 0.25, 0.1}) {
        ViewFields fitted({width, width / 2}, {n, n}, sphere_maker(share));
        fitted.most_samples = fitted.most_pixels = coarse_samples;
        TESSERA_TRY_ASSIGN(const double error,
                           error_of_trial(SeenSphere(sphere.centre, sphere.radius), fitted,
                                          photographs, options, "choosing the focus"));
        if (least == 0 || error < least) {
            best = share;
            least = error;
        }
    }
    return best;
}

ViewFields window_fields(const SizedWindow& sized) {
    return {sized.pixels, sized.window.cameras, make_window_field};
}

} // namespace

Result<ViewFit> fit_sphere(const PhotoSphere& sphere, std::span<const PosedPhotograph> photographs,
                           const ViewFitOptions& options) {
    TESSERA_TRY(check_views(options));
    if (photographs.empty() || !(sphere.radius > 0))
        return Status(ErrorCode::bad_argument, "a sphere needs photographs and a radius above 0");
    const std::uint32_t n =
        options.directions > 0 ? options.directions : directions_of(sphere, photographs);
    const std::uint32_t width = width_on(sphere, photographs, n, options.most_texels);
    double share = std::min(options.focus / sphere.radius, 1.0);
    if (options.focus == 0) {
        TESSERA_TRY_ASSIGN(share, choose_share(sphere, n, photographs, options));
    }
    ViewFields fitted({width, width / 2}, {n, n}, sphere_maker(share));
    TESSERA_TRY_ASSIGN(ViewFit fit, fit_views(SeenSphere(sphere.centre, sphere.radius), fitted,
                                              photographs, options));
    fit.focus = share * sphere.radius;
    return fit;
}

Result<ViewFit> fit_window(const SizedWindow& window, std::span<const PosedPhotograph> photographs,
                           const ViewFitOptions& options) {
    TESSERA_TRY(check_views(options));
    ViewFields fitted = window_fields(window);
    return fit_views(SeenWindow(window.window), fitted, photographs, options);
}

Result<double> choose_focus(std::span<const PosedPhotograph> photographs,
                            const ViewFitOptions& given) {
    ViewFitOptions options = given;
    options.smoothness = 1;
    options.iterations = 20;
    const auto error_at = [&](double focus) -> Result<double> {
        TESSERA_TRY_ASSIGN(const SizedWindow window,
                           window_of(photographs, focus, options.directions, coarse_texels));
        ViewFields fitted = window_fields(window);
        fitted.most_samples = fitted.most_pixels = coarse_samples;
        return error_of_trial(SeenWindow(window.window), fitted, photographs, options,
                              "choosing the focus");
    };
    double best = 0, least = 0;
    Status failed;
    const auto attempt = [&](double focus) {
        const Result<double> error = error_at(focus);
        if (!error.ok())
            failed = error.status();
        else if (best == 0 || *error < least) {
            best = focus;
            least = *error;
        }
    };
    for (const double focus : possible_focuses(photographs))
        attempt(focus);
    // Between the neighbours of the best one.
    for (const double step : {0.25, 0.125, 0.0625}) {
        const double middle = best;
        for (const double side : {-step, step})
            if (middle > 0)
                attempt(middle * std::exp2(side));
    }
    if (options.run.cancelled && options.run.cancelled())
        return Status(ErrorCode::runtime, "interrupted");
    if (best == 0)
        return failed.ok() ? window_of(photographs, 1.0, 0, coarse_texels).status() : failed;
    return best;
}

} // namespace tessera::corpus
