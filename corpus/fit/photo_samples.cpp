#include "corpus/fit/photo_samples.h"

#include "corpus/trace/path_random.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera::corpus {
namespace {

// What one photograph adds to PhotoSamples; `begin` and `end` of its pixels count its own samples.
struct TracedPhotograph {
    std::vector<PhotoSample> samples;
    std::vector<PhotoPixel> pixels;
};

class PhotographTracer {
public:
    PhotographTracer(const SeenSurface& surface, const PhotoTraceOptions& options)
        : surface_(surface), options_(options),
          weight_(1.0f / static_cast<float>(options.rays * options.rays)) {}

    TracedPhotograph trace(const PhotoCamera& camera, const PhotoPixels& pixels,
                           std::uint64_t number) const {
        TracedPhotograph traced;
        for (std::uint32_t y = 0; y < camera.height; ++y)
            for (std::uint32_t x = 0; x < camera.width; ++x) {
                PathRandom random(number, y * camera.width + x);
                const auto& texel = pixels.texels[std::size_t{y} * camera.width + x];
                if (texel[3] > 0.0f && random.next() < options_.share)
                    add_pixel(traced, camera, x, y, texel, random);
            }
        return traced;
    }

private:
    void add_pixel(TracedPhotograph& traced, const PhotoCamera& camera, std::uint32_t x,
                   std::uint32_t y, const std::array<float, 4>& texel, PathRandom& random) const {
        PhotoPixel pixel{x, y, static_cast<std::uint32_t>(traced.samples.size()), 0, 0.0f, {}, 0};
        const unsigned n = options_.rays;
        for (unsigned j = 0; j < n; ++j)
            for (unsigned i = 0; i < n; ++i) {
                const glm::dvec2 r = options_.is_centred ? glm::dvec2(0.5) : random.next2();
                const glm::dvec3 direction =
                    camera.direction(x + options_.filter.place((i + r.x) / n),
                                     y + options_.filter.place((j + r.y) / n));
                if (auto seen = surface_.seen(camera.eye, direction)) {
                    seen->weight = weight_;
                    traced.samples.push_back(*seen);
                }
            }
        pixel.end = static_cast<std::uint32_t>(traced.samples.size());
        if (pixel.begin == pixel.end)
            return;
        pixel.coverage = static_cast<float>(pixel.end - pixel.begin) * weight_;
        pixel.weight = texel[3];
        for (std::size_t c = 0; c < 3; ++c)
            pixel.colour[c] = texel[c];
        if (options_.background)
            for (std::size_t c = 0; c < 3; ++c)
                pixel.colour[c] -=
                    (1.0f - pixel.coverage) *
                    static_cast<float>((*options_.background)[static_cast<glm::length_t>(c)]);
        else if (!is_inside(camera, x, y) || pixel.end - pixel.begin < n * n)
            pixel.weight = 0.0f;
        traced.pixels.push_back(pixel);
    }

    // Whether rays around the pixel meet the surface, too.
    bool is_inside(const PhotoCamera& camera, std::uint32_t x, std::uint32_t y) const {
        constexpr double margin = 1.5; // pixels
        for (const auto& [dx, dy] :
             {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)})
            if (!surface_.seen(camera.eye,
                               camera.direction(x + 0.5 + margin * dx, y + 0.5 + margin * dy)))
                return false;
        return true;
    }

    const SeenSurface& surface_;
    const PhotoTraceOptions& options_;
    float weight_; // of a ray
};

Result<PhotoSamples> joined(std::vector<TracedPhotograph> traced) {
    std::uint64_t samples = 0, pixels = 0;
    for (const TracedPhotograph& photograph : traced) {
        samples += photograph.samples.size();
        pixels += photograph.pixels.size();
    }
    if (samples > std::numeric_limits<std::uint32_t>::max())
        return Status(ErrorCode::unsupported, "the photographs have too many pixels");
    PhotoSamples all;
    all.samples.reserve(samples);
    all.pixels.reserve(pixels);
    for (TracedPhotograph& photograph : traced) {
        all.first.push_back(all.pixels.size());
        const auto before = static_cast<std::uint32_t>(all.samples.size());
        for (PhotoPixel pixel : photograph.pixels) {
            pixel.begin += before;
            pixel.end += before;
            all.pixels.push_back(pixel);
        }
        all.samples.insert(all.samples.end(), photograph.samples.begin(), photograph.samples.end());
        photograph = {};
    }
    all.first.push_back(all.pixels.size());
    return all;
}

} // namespace

Result<std::optional<glm::dvec3>> common_background(std::span<const PosedPhotograph> photographs) {
    constexpr std::size_t most_read = 16;
    constexpr float tolerance = 2.5f / 255.0f;
    std::array<float, 3> low{2.0f, 2.0f, 2.0f}, high{-1.0f, -1.0f, -1.0f};
    const std::size_t count = std::min(most_read, photographs.size());
    for (std::size_t i = 0; i < count; ++i) {
        TESSERA_TRY_ASSIGN(
            const PhotoPixels pixels,
            read_photograph(photographs[i * photographs.size() / count], glm::dvec3(0.0)));
        for (std::uint32_t y = 0; y < pixels.height; ++y)
            for (std::uint32_t x = 0; x < pixels.width; ++x) {
                const bool inside = y > 0 && y + 1 < pixels.height;
                if (inside && x > 0 && x + 1 < pixels.width)
                    x = pixels.width - 1;
                const auto& texel = pixels.texels[std::size_t{y} * pixels.width + x];
                if (texel[3] <= 0.0f)
                    continue;
                for (std::size_t c = 0; c < 3; ++c) {
                    low[c] = std::min(low[c], texel[c]);
                    high[c] = std::max(high[c], texel[c]);
                }
            }
    }
    glm::dvec3 middle(0.0);
    for (std::size_t c = 0; c < 3; ++c) {
        if (!(high[c] - low[c] <= 2.0f * tolerance) || high[c] < low[c])
            return std::optional<glm::dvec3>();
        middle[static_cast<glm::length_t>(c)] =
            0.5 * (static_cast<double>(low[c]) + static_cast<double>(high[c]));
    }
    return std::optional(middle);
}

Result<PhotoSamples> trace_photographs(const SeenSurface& surface,
                                       std::span<const PosedPhotograph> photographs,
                                       const PhotoTraceOptions& options) {
    const PhotographTracer tracer(surface, options);
    std::vector<TracedPhotograph> traced(photographs.size());
    std::vector<Status> failed(photographs.size());
    TESSERA_TRY(for_rows("tracing", static_cast<std::uint32_t>(photographs.size()), options.run,
                         [&](std::uint32_t i) {
                             auto pixels = read_photograph(photographs[i], glm::dvec3(0.0));
                             if (pixels.ok())
                                 traced[i] = tracer.trace(photographs[i].camera, *pixels, i);
                             else
                                 failed[i] = pixels.status();
                         }));
    for (const Status& status : failed)
        TESSERA_TRY(Status(status));
    TESSERA_TRY_ASSIGN(PhotoSamples all, joined(std::move(traced)));
    if (all.samples.empty())
        return Status(ErrorCode::bad_argument, surface.unseen());
    return all;
}

} // namespace tessera::corpus
