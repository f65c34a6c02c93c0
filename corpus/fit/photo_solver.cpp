#include "corpus/fit/photo_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tessera::corpus {
namespace {

constexpr double outlier_times = 12.0; // errors, see weigh_outliers()
// A photograph is wrong if its error exceeds the median by this factor, and by so many deviations.
constexpr double wrong_times = 1.75, wrong_deviations = 3.0;
constexpr double least_gain = 0.01;           // that is corrected
constexpr double least_shift = 0.1;           // that is corrected, pixels
constexpr unsigned correction_rounds = 2;     // of poses and wrong photographs
constexpr unsigned trials_per_photograph = 5; // every so many are kept out of trial fits
constexpr std::array<double, 3> trial_smoothness{0.25, 1.0, 4.0};

double median(std::vector<double> numbers) {
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

// The photographs that take part in a fit, and all that was found out about them.
class Fit {
public:
    Fit(const SeenSurface& surface, FittedFields& fitted, const PhotoSolveOptions& options)
        : surface_(surface), fitted_(fitted), fields_(fitted.fields), options_(options) {}

    PhotoTraceOptions trace_options(std::span<const PosedPhotograph> photographs) const {
        double seen = 0; // pixels: about a quarter of a picture shows the object
        for (const PosedPhotograph& p : photographs)
            seen += 0.25 * static_cast<double>(p.camera.width) * p.camera.height;
        return {.filter = options_.filter,
                .rays = static_cast<unsigned>(std::clamp(std::sqrt(fitted_.most_samples / seen),
                                                         static_cast<double>(fitted_.least_rays),
                                                         static_cast<double>(fitted_.most_rays))),
                .share = std::min(1.0, fitted_.most_pixels / seen),
                .is_centred = fitted_.most_rays == 1,
                .background = options_.background,
                .run = options_.run};
    }

    // Fits all fields from where they stand.
    Status solve(const PhotoSamples& samples, double smoothness, unsigned iterations,
                 const char* stage) {
        fitted_.set_costs(samples, smoothness);
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
            for (std::size_t i = 0; i < fields_[0].values.size(); ++i)
                fields_[0].values[i] = static_cast<float>(sum[i % 3] / coverage);
    }

    struct Trial {
        double smoothness = 0, error = 0; // the median over the photographs that were kept out
    };

    // The trial whose smoothness predicts photographs best that are kept out.
    Result<Trial> best_trial(std::span<const PosedPhotograph> photographs,
                             std::span<const double> smoothnesses, const char* stage) {
        std::vector<PosedPhotograph> fitted, kept_out;
        for (std::size_t i = 0; i < photographs.size(); ++i)
            (i % trials_per_photograph == 2 ? kept_out : fitted).push_back(photographs[i]);
        if (kept_out.empty() || fitted.empty())
            return Trial{smoothnesses[smoothnesses.size() / 2], 0};
        PhotoTraceOptions trace = trace_options(photographs);
        trace.rays = 1;
        trace.share *= 0.5;
        TESSERA_TRY_ASSIGN(const PhotoSamples samples, trace_photographs(surface_, fitted, trace));
        TESSERA_TRY_ASSIGN(const PhotoSamples tests, trace_photographs(surface_, kept_out, trace));
        Trial best;
        for (const double smoothness : smoothnesses) {
            reset(samples);
            TESSERA_TRY(solve(samples, smoothness, options_.iterations / 2, stage));
            // The median, because some photographs may be wrong.
            std::vector<double> errors;
            for (const PhotoDifference& d : differences(tests))
                errors.push_back(d.error);
            const double error = median(errors);
            if (best.smoothness == 0 || error < best.error)
                best = {smoothness, error};
        }
        return best;
    }

    std::vector<PhotoDifference> differences(const PhotoSamples& samples) const {
        return photo_differences(samples, predicted(samples));
    }

    PixelColours predicted(const PhotoSamples& samples) const {
        return predict(fields_, samples, options_.run.threads);
    }

    // Weighs outliers down.
    void weigh(PhotoSamples& samples) const {
        weigh_outliers(samples, predicted(samples), outlier_times);
    }

private:
    const SeenSurface& surface_;
    FittedFields& fitted_;
    std::vector<TextureField>& fields_;
    const PhotoSolveOptions& options_;
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
             const std::vector<PhotoDifference>& differences, PhotoFindings& out) {
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

} // namespace

Result<double> error_of_trial(const SeenSurface& surface, FittedFields& fields,
                              std::span<const PosedPhotograph> photographs,
                              const PhotoSolveOptions& options, const char* stage) {
    Fit fit(surface, fields, options);
    TESSERA_TRY_ASSIGN(const auto trial,
                       fit.best_trial(photographs, std::array{options.smoothness}, stage));
    return trial.error;
}

Result<PhotoFindings> solve_photographs(const SeenSurface& surface, FittedFields& fields,
                                        std::span<const PosedPhotograph> all_photographs,
                                        const PhotoSolveOptions& given) {
    if (all_photographs.empty())
        return Status(ErrorCode::bad_argument, "there are no photographs");
    if (!(given.smoothness >= 0.0) || !std::isfinite(given.smoothness))
        return Status(ErrorCode::bad_argument, "the smoothness is at least 0");
    PhotoSolveOptions options = given;
    PhotoFindings out;
    if (!options.background) {
        TESSERA_TRY_ASSIGN(options.background, common_background(all_photographs));
    }
    out.background = options.background;
    Fit fit(surface, fields, options);

    std::vector<PosedPhotograph> photographs(all_photographs.begin(), all_photographs.end());
    std::vector<std::size_t> numbers(photographs.size());
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    out.differences.resize(photographs.size());

    out.smoothness = options.smoothness;
    if (out.smoothness == 0.0) {
        TESSERA_TRY_ASSIGN(const auto best,
                           fit.best_trial(photographs, trial_smoothness, "choosing smoothness"));
        out.smoothness = best.smoothness;
    }
    TESSERA_TRY_ASSIGN(PhotoSamples samples,
                       trace_photographs(surface, photographs, fit.trace_options(photographs)));
    if (std::ranges::none_of(samples.pixels, [](const PhotoPixel& p) { return p.weight > 0.0f; }))
        return Status(ErrorCode::bad_argument,
                      "no pixel shows the object alone, and the background varies; state the "
                      "background's colour if it has one");
    fit.reset(samples);
    TESSERA_TRY(fit.solve(samples, out.smoothness, options.iterations, "fitting"));
    if (options.corrects) {
        for (unsigned round = 0; round < correction_rounds; ++round) {
            if (!correct(photographs, numbers, fit.differences(samples), out))
                break;
            TESSERA_TRY_ASSIGN(
                samples, trace_photographs(surface, photographs, fit.trace_options(photographs)));
            TESSERA_TRY(fit.solve(samples, out.smoothness, options.iterations / 2, "correcting"));
        }
        equalise(samples, fit.differences(samples));
        fit.weigh(samples);
        TESSERA_TRY(fit.solve(samples, out.smoothness, options.iterations, "fitting again"));
    }
    const PixelColours predicted = fit.predicted(samples);
    double error = 0;
    const auto differences = photo_differences(samples, predicted);
    for (const PhotoDifference& d : differences)
        error += d.error * d.error / static_cast<double>(differences.size());
    out.error = std::sqrt(error);
    out.pixels = samples.pixels.size();
    fields.seen.clear();
    for (const TextureField& field : fields.fields)
        fields.seen.push_back(seen_texels(field, samples));

    return out;
}

} // namespace tessera::corpus
