#include "corpus/fit/least_squares.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

// Sums over pixels are made of this many parts, whatever the number of threads, so that rounding is
// always the same.
constexpr std::size_t parts = 8;

using Values = std::vector<std::vector<float>>; // of each field

Values zeros(std::span<const TextureField> fields) {
    Values values;
    for (const TextureField& field : fields)
        values.emplace_back(3 * field.places() * field.texels_per_place(), 0.0f);
    return values;
}

double dot(const Values& a, const Values& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
        for (std::size_t i = 0; i < a[k].size(); ++i)
            sum += static_cast<double>(a[k][i]) * static_cast<double>(b[k][i]);
    return sum;
}

// to += factor * from
void add(Values& to, double factor, const Values& from) {
    const auto f = static_cast<float>(factor);
    for (std::size_t k = 0; k < to.size(); ++k)
        for (std::size_t i = 0; i < to[k].size(); ++i)
            to[k][i] += f * from[k][i];
}

std::size_t part_begin(std::size_t part, std::size_t pixels) {
    return part * pixels / parts;
}

// Adds what a sample sees of `values`, which have the layout of field.values.
void add_seen(const TextureField& field, const std::vector<float>& values,
              const PhotoSample& sample, std::array<float, 3>& colour) {
    const FieldTaps seen = taps(field, sample);
    for (unsigned j = 0; j < seen.count; ++j) {
        const float weight = sample.weight * seen.weight[j];
        const float* const x = values.data() + seen.first[j];
        for (std::size_t c = 0; c < 3; ++c)
            colour[c] += weight * x[c];
    }
}

// The squared weights with which pixels see each texel. The samples of a pixel mostly see the same
// texels, so their weights add up before they are squared.
std::vector<float> seen_weights(const TextureField& field, const PhotoSamples& samples) {
    std::vector<float> weights(field.places() * field.texels_per_place(), 0.0f);
    for (const PhotoPixel& pixel : samples.pixels)
        for (const PhotoSample& sample : samples.of(pixel)) {
            const FieldTaps seen = taps(field, sample);
            for (unsigned j = 0; j < seen.count; ++j)
                weights[seen.first[j] / 3] +=
                    pixel.weight * pixel.coverage * sample.weight * seen.weight[j] * seen.weight[j];
        }
    return weights;
}

class NormalEquations {
public:
    NormalEquations(std::span<const TextureField> fields, const PhotoSamples& samples,
                    unsigned threads)
        : fields_(fields), samples_(samples), threads_(threads), sums_(parts, zeros(fields)) {}

    // The sum over fields of what each pixel sees of `values`.
    Status see(const Values& values, PixelColours& seen) const {
        seen.assign(samples_.pixels.size(), {0.0f, 0.0f, 0.0f});
        return parallel_for(parts, threads_, [&](std::size_t part) -> Status {
            for (std::size_t i = part_begin(part, seen.size());
                 i < part_begin(part + 1, seen.size()); ++i)
                for (const PhotoSample& sample : samples_.of(samples_.pixels[i]))
                    for (std::size_t k = 0; k < fields_.size(); ++k)
                        add_seen(fields_[k], values[k], sample, seen[i]);
            return {};
        });
    }

    // The transpose: adds each pixel's weighted colour to the texels that it sees. Replaces `out`.
    Status spread(const PixelColours& colours, Values& out) {
        TESSERA_TRY(parallel_for(parts, threads_, [&](std::size_t part) -> Status {
            Values& sum = sums_[part];
            for (auto& values : sum)
                std::ranges::fill(values, 0.0f);
            for (std::size_t i = part_begin(part, colours.size());
                 i < part_begin(part + 1, colours.size()); ++i)
                spread_pixel(samples_.pixels[i], colours[i], sum);
            return {};
        }));
        return parallel_for(fields_.size(), threads_, [&](std::size_t k) -> Status {
            out[k] = sums_[0][k];
            for (std::size_t part = 1; part < parts; ++part)
                for (std::size_t i = 0; i < out[k].size(); ++i)
                    out[k][i] += sums_[part][k][i];
            return {};
        });
    }

    // The product with the matrix of the normal equations.
    Status multiply(const Values& values, Values& out) {
        TESSERA_TRY(see(values, seen_));
        TESSERA_TRY(spread(seen_, out));
        for (std::size_t k = 0; k < fields_.size(); ++k)
            add_smoothness(fields_[k], values[k], out[k]);
        return {};
    }

    // The inverse of an estimate of the matrix's diagonal.
    Values preconditioner() const {
        Values inverse;
        for (const TextureField& field : fields_) {
            const auto own = static_cast<float>(field.shrink + 4.0 * field.smooth_places +
                                                4.0 * field.smooth_directions + 1e-6);
            auto& values = inverse.emplace_back();
            for (const float weight : seen_weights(field, samples_))
                values.insert(values.end(), 3, 1.0f / (weight + own));
        }
        return inverse;
    }

private:
    void spread_pixel(const PhotoPixel& pixel, const std::array<float, 3>& colour,
                      Values& sum) const {
        if (pixel.weight <= 0.0f)
            return;
        for (const PhotoSample& sample : samples_.of(pixel))
            for (std::size_t k = 0; k < fields_.size(); ++k) {
                const FieldTaps seen = taps(fields_[k], sample);
                float* const to = sum[k].data();
                for (unsigned j = 0; j < seen.count; ++j) {
                    const float weight = pixel.weight * sample.weight * seen.weight[j];
                    float* const x = to + seen.first[j];
                    for (std::size_t c = 0; c < 3; ++c)
                        x[c] += weight * colour[c];
                }
            }
    }

    std::span<const TextureField> fields_;
    const PhotoSamples& samples_;
    unsigned threads_;
    std::vector<Values> sums_;
    PixelColours seen_;
};

Values product(const Values& a, const Values& b) {
    Values out = a;
    for (std::size_t k = 0; k < a.size(); ++k)
        for (std::size_t i = 0; i < a[k].size(); ++i)
            out[k][i] *= b[k][i];
    return out;
}

} // namespace

PixelColours predict(std::span<const TextureField> fields, const PhotoSamples& samples,
                     unsigned threads) {
    constexpr std::size_t chunk_pixels = 4096;
    PixelColours seen(samples.pixels.size());
    // The work cannot fail.
    static_cast<void>(
        parallel_for(seen.size() / chunk_pixels + 1, threads, [&](std::size_t chunk) -> Status {
            const std::size_t end = std::min(seen.size(), (chunk + 1) * chunk_pixels);
            for (std::size_t i = chunk * chunk_pixels; i < end; ++i) {
                seen[i] = {0.0f, 0.0f, 0.0f};
                for (const PhotoSample& sample : samples.of(samples.pixels[i]))
                    for (const TextureField& field : fields)
                        add_seen(field, field.values, sample, seen[i]);
            }
            return {};
        }));
    return seen;
}

double seen_weight(const TextureField& field, const PhotoSamples& samples) {
    double sum = 0, count = 0;
    for (const float x : seen_weights(field, samples))
        if (x > 0.0f) {
            sum += static_cast<double>(x);
            ++count;
        }
    return count > 0 ? sum / count : 0.0;
}

std::vector<bool> seen_texels(const TextureField& field, const PhotoSamples& samples) {
    std::vector<bool> seen;
    for (const float x : seen_weights(field, samples))
        seen.push_back(x > 0.0f);
    return seen;
}

Status solve_least_squares(std::span<TextureField> fields, const PhotoSamples& samples,
                           unsigned iterations, const char* stage, const BakeRun& run) {
    NormalEquations equations(fields, samples, run.threads);
    Values values;
    for (const TextureField& field : fields)
        values.push_back(field.values);
    // The residual of the normal equations: the gradient, negated.
    Values residual = zeros(fields), product_of_step = zeros(fields);
    PixelColours colours(samples.pixels.size());
    for (std::size_t i = 0; i < colours.size(); ++i)
        colours[i] = samples.pixels[i].colour;
    TESSERA_TRY(equations.spread(colours, residual));
    TESSERA_TRY(equations.multiply(values, product_of_step));
    add(residual, -1.0, product_of_step);

    const Values scale = equations.preconditioner();
    Values scaled = product(scale, residual), step = scaled;
    double error = dot(residual, scaled);
    // Beyond it, steps follow rounding errors only.
    const double least_error = 1e-9 * error;
    for (unsigned i = 0; i < iterations && error > least_error; ++i) {
        if (run.cancelled && run.cancelled())
            return {ErrorCode::runtime, "interrupted"};
        TESSERA_TRY(equations.multiply(step, product_of_step));
        const double length = error / dot(step, product_of_step);
        add(values, length, step);
        add(residual, -length, product_of_step);
        scaled = product(scale, residual);
        const double next = dot(residual, scaled);
        const auto kept = static_cast<float>(next / error);
        error = next;
        for (std::size_t k = 0; k < step.size(); ++k)
            for (std::size_t j = 0; j < step[k].size(); ++j)
                step[k][j] = scaled[k][j] + kept * step[k][j];
        if (run.progress)
            run.progress(stage, i + 1.0, iterations);
    }
    for (std::size_t k = 0; k < fields.size(); ++k)
        fields[k].values = std::move(values[k]);
    return {};
}

} // namespace tessera::corpus
