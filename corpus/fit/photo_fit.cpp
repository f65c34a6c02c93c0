#include "corpus/fit/photo_fit.h"

#include "corpus/fit/fit_atlas.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tessera::corpus {
namespace {

constexpr double most_fitted_pixels = 4e6, most_fitted_samples = 16e6;
constexpr double most_direction_texels = 8e6; // of the field of groups
constexpr double outlier_times = 12.0;        // errors, see weigh_outliers()
// A photograph is wrong if its error exceeds the median by this factor, and by so many deviations.
constexpr double wrong_times = 1.75, wrong_deviations = 3.0;
constexpr double least_gain = 0.01;           // that is corrected
constexpr double least_shift = 0.1;           // that is corrected, pixels
constexpr unsigned correction_rounds = 2;     // of poses and wrong photographs
constexpr unsigned trials_per_photograph = 5; // every so many are kept out of trial fits
constexpr std::array<double, 3> trial_smoothness{0.25, 1.0, 4.0};

enum FieldPart : std::size_t { colour, shared, local };
using Fields = std::vector<TextureField>;

// Errors of a fit are not noise: those of neighbouring pixels and of many photographs are alike. So
// costs of neighbours grow with the number of pixels that see a texel. The factors are those with
// which photographs that were kept out fit best, of a metal (smoothness 0.25) and of boxes (4).
void set_costs(Fields& fields, const PhotoSamples& samples, double smoothness) {
    const auto seen = [&](FieldPart part) { return seen_weight(fields[part], samples); };
    fields[colour].smooth_places = 0.1 * seen(colour);
    fields[colour].shrink = 1e-5 * seen(colour);
    fields[shared].smooth_directions = 0.1 * smoothness * smoothness * seen(shared);
    fields[shared].shrink = 1e-5 * seen(shared);
    fields[local].smooth_directions = 0.5 * smoothness * seen(local);
    fields[local].smooth_places = 2.0 * std::pow(smoothness, 1.5) * seen(local);
    fields[local].shrink = 0.1 * seen(local);
}

double median(std::vector<double> numbers) {
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

// The photographs that take part in a fit, and all that was found out about them.
class Fit {
public:
    Fit(const SeenMesh& mesh, const ModelAtlas& atlas, const PhotoFitOptions& options)
        : mesh_(mesh), options_(options) {
        fields_.push_back(make_field(atlas, options.cell, 1));
        fields_.push_back(make_shared_field(options.shared_directions));
        fields_.push_back(make_field(atlas, 1, options.directions));
    }

    Fields& fields() { return fields_; }

    PhotoTraceOptions trace_options(std::span<const PosedPhotograph> photographs) const {
        double seen = 0; // pixels: about a quarter of a picture shows the mesh
        for (const PosedPhotograph& p : photographs)
            seen += 0.25 * static_cast<double>(p.camera.width) * p.camera.height;
        return {.filter = options_.filter,
                .rays = static_cast<unsigned>(
                    std::clamp(std::sqrt(most_fitted_samples / seen), 2.0, 4.0)),
                .share = std::min(1.0, most_fitted_pixels / seen),
                .background = options_.background,
                .run = options_.run};
    }

    // Fits all fields from where they stand.
    Status solve(const PhotoSamples& samples, double smoothness, unsigned iterations,
                 const char* stage) {
        set_costs(fields_, samples, smoothness);
        return solve_least_squares(fields_, samples, iterations, stage, options_.run);
    }

    // The mean colour everywhere, so that places that no photograph shows have it.
    void reset(const PhotoSamples& samples) {
        std::array<double, 3> sum{};
        double coverage = 0;
        for (const PhotoPixel& pixel : samples.pixels) {
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += static_cast<double>(pixel.weight) * static_cast<double>(pixel.colour[c]);
            coverage += static_cast<double>(pixel.weight) * static_cast<double>(pixel.coverage);
        }
        for (TextureField& field : fields_)
            field.clear();
        if (coverage > 0)
            for (std::size_t i = 0; i < fields_[colour].values.size(); ++i)
                fields_[colour].values[i] = static_cast<float>(sum[i % 3] / coverage);
    }

    // The smoothness with which photographs that are kept out are predicted best.
    Result<double> choose_smoothness(std::span<const PosedPhotograph> photographs) {
        std::vector<PosedPhotograph> fitted, kept_out;
        for (std::size_t i = 0; i < photographs.size(); ++i)
            (i % trials_per_photograph == 2 ? kept_out : fitted).push_back(photographs[i]);
        if (kept_out.empty() || fitted.empty())
            return trial_smoothness[1];
        PhotoTraceOptions trace = trace_options(photographs);
        trace.rays = 1;
        trace.share *= 0.5;
        TESSERA_TRY_ASSIGN(const PhotoSamples samples, trace_photographs(mesh_, fitted, trace));
        TESSERA_TRY_ASSIGN(const PhotoSamples tests, trace_photographs(mesh_, kept_out, trace));
        double best = 0, least = 0;
        for (const double smoothness : trial_smoothness) {
            reset(samples);
            TESSERA_TRY(solve(samples, smoothness, options_.iterations / 2, "choosing smoothness"));
            // The median, because some photographs may be wrong.
            std::vector<double> errors;
            for (const PhotoDifference& d : differences(tests))
                errors.push_back(d.error);
            const double error = median(errors);
            if (best == 0 || error < least) {
                best = smoothness;
                least = error;
            }
        }
        return best;
    }

    std::vector<PhotoDifference> differences(const PhotoSamples& samples) const {
        return photo_differences(samples, predict(fields_, samples, options_.run.threads));
    }

    // Weighs outliers down.
    void weigh(PhotoSamples& samples) const {
        weigh_outliers(samples, predict(fields_, samples, options_.run.threads), outlier_times);
    }

private:
    const SeenMesh& mesh_;
    const PhotoFitOptions& options_;
    Fields fields_;
};

// The largest error of a photograph that is not wrong.
double most_error(const std::vector<PhotoDifference>& differences) {
    constexpr double least = 0.02;        // a fit may be nearly exact
    constexpr double per_median = 1.4826; // the standard deviation of a normal distribution
    std::vector<double> errors;
    for (const PhotoDifference& d : differences)
        errors.push_back(d.error);
    const double usual = median(errors);
    for (double& error : errors)
        error = std::abs(error - usual);
    return std::max(
        {least, wrong_times * usual, usual + wrong_deviations * per_median * median(errors)});
}

// Moves the pictures to where the others show the mesh, and leaves out those that fit none of them.
// Returns whether anything changed.
bool correct(std::vector<PosedPhotograph>& photographs, std::vector<std::size_t>& numbers,
             const std::vector<PhotoDifference>& differences, PhotoFit& out) {
    const double most = most_error(differences);
    std::vector<PosedPhotograph> kept;
    std::vector<std::size_t> kept_numbers;
    bool changed = false;
    for (std::size_t i = 0; i < photographs.size(); ++i) {
        PhotoDifference& total = out.differences[numbers[i]];
        total.error = differences[i].error;
        total.gain = differences[i].gain;
        if (differences[i].error > most) {
            out.left_out.push_back(numbers[i]);
            changed = true;
            continue;
        }
        PosedPhotograph photograph = photographs[i];
        const glm::dvec2& shift = differences[i].shift;
        if (std::max(std::abs(shift.x), std::abs(shift.y)) > least_shift) {
            photograph.camera.cx += shift.x;
            photograph.camera.cy += shift.y;
            total.shift += shift;
            changed = true;
        }
        kept.push_back(std::move(photograph));
        kept_numbers.push_back(numbers[i]);
    }
    photographs = std::move(kept);
    numbers = std::move(kept_numbers);
    return changed;
}

// Divides colours by the gains of their photographs, relative to the mean of all.
void equalise(PhotoSamples& samples, const std::vector<PhotoDifference>& differences) {
    std::array<double, 3> mean{};
    for (const PhotoDifference& d : differences)
        for (std::size_t c = 0; c < 3; ++c)
            mean[c] += std::log(d.gain[c]) / static_cast<double>(differences.size());
    for (std::size_t n = 0; n < differences.size(); ++n)
        for (std::size_t c = 0; c < 3; ++c) {
            const double gain = differences[n].gain[c] / std::exp(mean[c]);
            if (std::abs(gain - 1.0) < least_gain)
                continue;
            for (std::size_t i = samples.first[n]; i < samples.first[n + 1]; ++i)
                samples.pixels[i].colour[c] /= static_cast<float>(gain);
        }
}

// Values of 0..1 as a layer of colour, those around 0 as one of differences.
LayerTexture layer_of(const TextureField& field, const SurfaceMesh& mesh, LayerRole role,
                      std::uint32_t tile_places, double quality_change) {
    const std::uint32_t n = field.directions;
    LayerTexture layer = make_layer(role, {field.width, field.height, n, n}, 3);
    const bool is_colour = role == LayerRole::diffuse;
    layer.transfer = is_colour ? Transfer::srgb : Transfer::unspecified;
    double most = 1e-3;
    if (!is_colour)
        for (const float x : field.values)
            most = std::max(most, std::abs(static_cast<double>(x)));
    layer.scale = is_colour ? 1.0 : std::min(most, 1.0);
    const std::vector<bool> visible =
        field.places() == 1 ? std::vector<bool>(1, true) : visible_places(mesh, field);
    const std::size_t per_place = field.texels_per_place();
    const auto value = [&](std::size_t i) {
        const auto x = static_cast<double>(field.values[i]);
        return is_colour ? x : (128.0 + 127.0 * std::clamp(x / layer.scale, -1.0, 1.0)) / 255.0;
    };
    for (std::size_t place = 0; place < field.places(); ++place)
        if (visible[place])
            for (std::size_t k = 0; k < per_place; ++k) {
                // The field's order is that of textures: v, u, t, s.
                const std::size_t texel = place * per_place + k;
                store_values(layer, texel,
                             {value(3 * texel), value(3 * texel + 1), value(3 * texel + 2)});
            }
    layer.quality_change = quality_change;
    layer.tile = {std::min(tile_places, field.width), std::min(tile_places, field.height),
                  std::min(n, 32u), std::min(n, 32u)};
    return layer;
}

Status check(const PhotoFitOptions& o, std::size_t photographs) {
    if (photographs == 0)
        return {ErrorCode::bad_argument, "there are no photographs"};
    if (o.cell < 1 || o.cell > 64 || o.directions < 1 || o.directions > 128 ||
        o.shared_directions < 1 || o.shared_directions > 256)
        return {ErrorCode::bad_argument,
                "cells have 1 to 64 texels, groups 1 to 128 directions, all places 1 to 256"};
    if (!(o.most_texels >= 1.0 && o.most_texels <= 1e8) || !(o.density >= 0.0) ||
        !(o.smoothness >= 0.0) || !std::isfinite(o.smoothness))
        return {ErrorCode::bad_argument, "texels are 1 to 10^8, density and smoothness at least 0"};
    return {};
}

Result<ModelAtlas> make_fit_atlas(const Model& model, std::span<const PosedPhotograph> photographs,
                                  const PhotoFitOptions& options) {
    double density = options.density;
    if (density == 0.0) {
        TESSERA_TRY_ASSIGN(density, density_of_pixels(model, photographs));
    }
    const double area = surface_area(model);
    density = std::min(density, std::sqrt(options.most_texels / area));
    const double places = most_direction_texels / (options.directions * options.directions);
    ModelAtlasOptions layout;
    layout.density = std::min(density / options.cell, std::sqrt(places / area));
    layout.tile = {4, 4};
    layout.position_bits = options.position_bits;
    layout.normal_bits = options.normal_bits;
    layout.uv_shift = 2;
    return make_model_atlas(model, layout);
}

} // namespace

Result<PhotoFit> fit_photographs(const Model& model,
                                 std::span<const PosedPhotograph> all_photographs,
                                 const PhotoFitOptions& given) {
    TESSERA_TRY(check(given, all_photographs.size()));
    PhotoFitOptions options = given;
    PhotoFit out;
    if (!options.background) {
        TESSERA_TRY_ASSIGN(options.background, common_background(all_photographs));
    }
    out.background = options.background;
    TESSERA_TRY_ASSIGN(const ModelAtlas atlas, make_fit_atlas(model, all_photographs, options));
    TESSERA_TRY_ASSIGN(const SeenMesh mesh, SeenMesh::make(atlas.mesh));
    Fit fit(mesh, atlas, options);

    std::vector<PosedPhotograph> photographs(all_photographs.begin(), all_photographs.end());
    std::vector<std::size_t> numbers(photographs.size());
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    out.differences.resize(photographs.size());

    out.smoothness = options.smoothness;
    if (out.smoothness == 0.0) {
        TESSERA_TRY_ASSIGN(out.smoothness, fit.choose_smoothness(photographs));
    }
    TESSERA_TRY_ASSIGN(PhotoSamples samples,
                       trace_photographs(mesh, photographs, fit.trace_options(photographs)));
    if (std::ranges::none_of(samples.pixels, [](const PhotoPixel& p) { return p.weight > 0.0f; }))
        return Status(ErrorCode::bad_argument,
                      "no pixel shows the mesh alone, and the background varies; state the "
                      "background's colour if it has one");
    fit.reset(samples);
    TESSERA_TRY(fit.solve(samples, out.smoothness, options.iterations, "fitting"));
    if (options.corrects) {
        for (unsigned round = 0; round < correction_rounds; ++round) {
            if (!correct(photographs, numbers, fit.differences(samples), out))
                break;
            TESSERA_TRY_ASSIGN(
                samples, trace_photographs(mesh, photographs, fit.trace_options(photographs)));
            TESSERA_TRY(fit.solve(samples, out.smoothness, options.iterations / 2, "correcting"));
        }
        equalise(samples, fit.differences(samples));
        fit.weigh(samples);
        TESSERA_TRY(fit.solve(samples, out.smoothness, options.iterations, "fitting again"));
    }
    const PixelColours predicted = predict(fit.fields(), samples, options.run.threads);
    double error = 0;
    const auto differences = photo_differences(samples, predicted);
    for (const PhotoDifference& d : differences)
        error += d.error * d.error / static_cast<double>(differences.size());
    out.error = std::sqrt(error);
    out.pixels = samples.pixels.size();

    out.layers.mesh = atlas.stream;
    out.layers.decoded_mesh = atlas.mesh;
    out.layers.charts = atlas.charts.size();
    out.layers.density = atlas.density * options.cell;
    const auto add = [&](FieldPart part, LayerRole role, std::uint32_t tile_places,
                         double quality_change) {
        out.layers.layers.push_back(
            layer_of(fit.fields()[part], atlas.mesh, role, tile_places, quality_change));
    };
    // Errors of the smooth colours of a fit are seen less than those of a model's textures, and all
    // places see those of the shared differences, which take few bytes.
    add(colour, LayerRole::diffuse, 64, -10.0);
    add(shared, LayerRole::shared_difference, 1, 20.0);
    add(local, LayerRole::difference, 16, 0.0);
    return out;
}

} // namespace tessera::corpus
