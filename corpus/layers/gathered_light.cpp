#include "corpus/layers/gathered_light.h"

#include "corpus/layers/light_filter.h"
#include "corpus/layers/path_halves.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

constexpr std::uint64_t gathering_paths = 0x69727261; // added to the seed
constexpr std::uint32_t block_side = 16;              // texels whose noise is estimated together
constexpr std::uint32_t estimated = 2;                // one texel of so many along u and v

class Gatherer {
public:
    Gatherer(const ModelPlaces& places, const OpenPlaces& open, const Tracer& tracer,
             std::span<const std::uint32_t> charts, std::span<const glm::vec3> direct,
             const GatherOptions& options, const BakeRun& run)
        : places_(places), open_(open), tracer_(tracer), charts_(charts), direct_(direct),
          options_(options), run_(run),
          size_(places.texel_places().size()), blocks_{(size_[0] + block_side - 1) / block_side,
                                                       (size_[1] + block_side - 1) / block_side},
          noisy_(std::size_t{blocks_[0]} * blocks_[1], 1), halves_(places.texels()),
          colours_(places.texels(), glm::vec3(0.0f)), normals_(places.texels(), glm::vec3(0.0f)),
          open_paths_(places.texels(), 0) {
        light_.light.resize(places.texels());
    }

    Result<GatheredLight> gather() {
        const LightFilter::Beside beside = [&](std::uint32_t u, std::uint32_t v, int x, int y) {
            return places_.texel_beside(u, v, glm::dvec2(x, y));
        };
        unsigned paths = std::max(options_.paths, 2u) / 2 * 2;
        TESSERA_TRY(trace(paths, 0));
        for (unsigned round = 1;; ++round) {
            TESSERA_TRY_ASSIGN(const LightFilter filter,
                               LightFilter::make(size_, halves_, charts_, normals_, run_, beside));
            TESSERA_TRY(estimate(filter));
            if (2 * paths > options_.most_paths ||
                std::ranges::count(noisy_, 0) == std::ssize(noisy_)) {
                TESSERA_TRY(apply(filter));
                return std::move(light_);
            }
            TESSERA_TRY(trace(paths, round)); // as many as before
            paths *= 2;
        }
    }

private:
    std::size_t index(std::uint32_t u, std::uint32_t v) const {
        return std::size_t{v} * size_[0] + u;
    }
    bool is_noisy(std::uint32_t u, std::uint32_t v) const {
        return noisy_[std::size_t{v / block_side} * blocks_[0] + u / block_side] != 0;
    }

    Status trace(unsigned paths, std::uint64_t round) {
        const std::uint64_t sequence = mix_bits(mix_bits(options_.seed + gathering_paths) + round);
        return for_rows("gathering light", size_[1], run_, [&](std::uint32_t v) {
            for (std::uint32_t u = 0; u < size_[0]; ++u)
                if (open_.matters(u, v) && is_noisy(u, v))
                    trace_texel({sequence, paths, u, v}, paths, u, v);
        });
    }

    void trace_texel(const TexelPaths& randoms, unsigned paths, std::uint32_t u, std::uint32_t v) {
        const std::size_t at = index(u, v);
        NoisyLight& noisy = halves_[at];
        if (noisy.paths == 0) {
            const ModelSurfacePlace centre = places_.place(u, v, {0.0, 0.0});
            normals_[at] = glm::vec3(centre.frame.ez);
            colours_[at] = glm::vec3(without_coats(centre.point.lobes).diffuse * options_.exposure);
        }
        const glm::dvec3 middle(normals_[at]);
        ArrivingLight<glm::dvec3> sum;
        const auto incoming = [&](PathRandom& random) {
            const LitPoint point = open_.smooth_place(places_, u, v, random.next2()).point;
            const Tracer::Incoming found =
                tracer_.incoming_of_model(point, options_.toward_emitters, random);
            open_paths_[at] += found.leaves_model ? 1 : 0;
            return found;
        };
        const auto halves = add_halves(randoms, paths, middle, incoming, sum);
        for (std::size_t half = 0; half < 2; ++half)
            noisy.halves[half] += glm::vec3(halves[half]);
        noisy.paths += paths / 2;
        light_.light[at].add(ArrivingLight<glm::vec3>(sum));
    }

    glm::dvec3 shown(std::size_t at, const glm::vec3& light) const {
        glm::dvec3 x(colours_[at] * (direct_[at] + light));
        for (glm::length_t c = 0; c < 3; ++c)
            x[c] = linear_to_srgb(x[c]);
        return x;
    }

    // How much the noise of a texel counts: the share of directions from which observers outside the
    // model see it, but not less than a part, because observers may be inside a room.
    double seen_share(std::size_t at) const {
        constexpr double least = 0.25;
        return std::max(open_paths_[at] / (2.0 * halves_[at].paths), least);
    }

    // Finds the blocks that are noisier than allowed.
    Status estimate(const LightFilter& filter) {
        const double most = std::pow(10.0, -options_.noise / 10.0);
        std::vector<double> errors(noisy_.size(), 0.0), counts(noisy_.size(), 0.0);
        TESSERA_TRY(for_rows("estimating noise", blocks_[1], run_, [&](std::uint32_t y) {
            for (std::uint32_t v = y * block_side; v < std::min((y + 1) * block_side, size_[1]);
                 v += estimated)
                for (std::uint32_t u = 0; u < size_[0]; u += estimated) {
                    const std::size_t at = index(u, v);
                    if (halves_[at].paths == 0)
                        continue;
                    const auto [a, b] = filter.filtered(u, v);
                    const glm::dvec3 error = (shown(at, a) - shown(at, b)) / 2.0;
                    const std::size_t block = std::size_t{y} * blocks_[0] + u / block_side;
                    errors[block] += seen_share(at) * glm::dot(error, error) / 3.0;
                    ++counts[block];
                }
        }));
        double error = 0, count = 0;
        for (std::size_t i = 0; i < noisy_.size(); ++i) {
            noisy_[i] = errors[i] > most * counts[i];
            error += errors[i];
            count += counts[i];
        }
        light_.noise = count > 0.0 ? error / count : 0.0;
        return {};
    }

    Status apply(const LightFilter& filter) {
        std::vector<ArrivingLight<glm::vec3>> all(light_.light.size());
        TESSERA_TRY(for_rows("filtering light", size_[1], run_, [&](std::uint32_t v) {
            std::vector<LightFilter::Share> shares;
            for (std::uint32_t u = 0; u < size_[0]; ++u) {
                const std::size_t at = index(u, v);
                if (halves_[at].paths == 0)
                    continue;
                const auto [a, b] = filter.filtered(u, v, &shares);
                for (const auto& [texel, share] : shares)
                    all[at].add(light_.light[texel], share);
                all[at].diffuse = (a + b) / 2.0f;
            }
        }));
        light_.light = std::move(all);
        return {};
    }

    const ModelPlaces& places_;
    const OpenPlaces& open_;
    const Tracer& tracer_;
    std::span<const std::uint32_t> charts_;
    std::span<const glm::vec3> direct_;
    const GatherOptions& options_;
    const BakeRun& run_;
    Texels2 size_, blocks_;
    std::vector<std::uint8_t> noisy_; // blocks that need more paths
    std::vector<NoisyLight> halves_;
    std::vector<glm::vec3> colours_, normals_;
    std::vector<std::uint32_t> open_paths_; // how many leave the model
    GatheredLight light_;                   // sums over the paths
};

} // namespace

Result<GatheredLight> gather_light(const ModelPlaces& places, const OpenPlaces& open,
                                   const Tracer& tracer, std::span<const std::uint32_t> charts,
                                   std::span<const glm::vec3> direct, const GatherOptions& options,
                                   const BakeRun& run) {
    return Gatherer(places, open, tracer, charts, direct, options, run).gather();
}

} // namespace tessera::corpus
