#include "corpus/layers/environment_layer.h"

#include "corpus/model/model.h"
#include "corpus/trace/lobes.h"
#include "format/surface_mesh.h"

#include <cmath>
#include <glm/common.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

using std::numbers::pi;

constexpr double first_lobe = 0.05;
constexpr double most_environment = 256.0; // times white
// With 128, lamps had rings around them: 1 dB less on smooth metal.
constexpr unsigned lobe_samples = 1024;

// Pictures of longitude and latitude, each half as wide and high as the one before.
class EnvironmentMips {
public:
    explicit EnvironmentMips(const Environment& environment) {
        constexpr int part = 2; // of the finest texels, along both sides
        Mip finest{1024, 512, {}};
        for (std::uint32_t y = 0; y < finest.height; ++y)
            for (std::uint32_t x = 0; x < finest.width; ++x) {
                glm::dvec3 sum(0.0);
                for (int k = 0; k < part * part; ++k) {
                    const int row = k / part, column = k % part;
                    const double polar = pi * (y + (row + 0.5) / part) / finest.height;
                    const double round =
                        2.0 * pi * ((x + (column + 0.5) / part) / finest.width - 0.5);
                    sum += environment.light({std::sin(polar) * std::cos(round), std::cos(polar),
                                              std::sin(polar) * std::sin(round)});
                }
                finest.texels.push_back(sum / static_cast<double>(part * part));
            }
        mips_.push_back(std::move(finest));
        while (mips_.back().height > 4) {
            const Mip& fine = mips_.back();
            Mip coarse{fine.width / 2, fine.height / 2, {}};
            for (std::uint32_t y = 0; y < coarse.height; ++y)
                for (std::uint32_t x = 0; x < coarse.width; ++x)
                    coarse.texels.push_back(
                        0.25 * (fine.at(2 * x, 2 * y) + fine.at(2 * x + 1, 2 * y) +
                                fine.at(2 * x, 2 * y + 1) + fine.at(2 * x + 1, 2 * y + 1)));
            mips_.push_back(std::move(coarse));
        }
    }

    // Which mip has texels of this many steradians.
    double mip_of(double angle) const {
        const double finest = pi / mips_.front().height;
        return std::clamp(std::log2(std::sqrt(angle) / finest), 0.0,
                          static_cast<double>(mips_.size() - 1));
    }
    // The mean light around a direction, over a patch as large as the texels of this mip.
    glm::dvec3 light(const glm::dvec3& direction, double mip) const {
        const auto first = static_cast<std::size_t>(mip);
        const glm::dvec2 place{std::atan2(direction.z, direction.x) / (2.0 * pi) + 0.5,
                               std::acos(std::clamp(direction.y, -1.0, 1.0)) / pi};
        const glm::dvec3 fine = mips_[first].sample(place);
        return first + 1 == mips_.size()
                   ? fine
                   : glm::mix(fine, mips_[first + 1].sample(place), mip - std::floor(mip));
    }

private:
    struct Mip {
        std::uint32_t width = 0, height = 0;
        std::vector<glm::dvec3> texels;

        const glm::dvec3& at(std::uint32_t x, std::uint32_t y) const {
            return texels[std::size_t{y} * width + x];
        }
        glm::dvec3 sample(const glm::dvec2& place) const {
            const double x = place.x * width - 0.5 + width;
            const double y = std::clamp(place.y * height - 0.5, 0.0, height - 1.0);
            const auto x0 = static_cast<std::uint32_t>(x), y0 = static_cast<std::uint32_t>(y);
            const std::uint32_t y1 = std::min(y0 + 1, height - 1);
            return glm::mix(glm::mix(at(x0 % width, y0), at((x0 + 1) % width, y0), x - x0),
                            glm::mix(at(x0 % width, y1), at((x0 + 1) % width, y1), x - x0), y - y0);
        }
    };
    std::vector<Mip> mips_;
};

// A direction of light in a lobe around z, its weight, and the mip for the solid angle that it stands
// for.
struct LobeSample {
    glm::dvec3 direction{0.0};
    double weight = 0, mip = 0;
};

// Samples whose density follows the lobe, and whose light is read from mips (Krivanek and Colbert,
// "Real-time shading with filtered importance sampling", 2008). The lobe is seen along the normal.
std::vector<LobeSample> samples_of(const EnvironmentMips& mips, double roughness) {
    const glm::dvec3 z(0.0, 0.0, 1.0);
    const double alpha = std::max(roughness * roughness, 1e-4);
    std::vector<LobeSample> samples;
    double weights = 0;
    for (unsigned i = 0; i < lobe_samples; ++i) {
        double reversed = 0; // van der Corput's sequence
        for (unsigned bits = i, k = 0; k < 16; ++k, bits >>= 1)
            reversed += (bits & 1) * std::ldexp(1.0, -static_cast<int>(k) - 1);
        const glm::dvec3 l = sample_ggx(alpha, z, z, {(i + 0.5) / lobe_samples, reversed});
        if (l.z <= 0.0)
            continue;
        const double density = ggx_density(alpha, std::sqrt(0.5 * (1.0 + l.z)), 1.0);
        samples.push_back({l, l.z, mips.mip_of(1.0 / (lobe_samples * density))});
        weights += l.z;
    }
    for (LobeSample& sample : samples)
        sample.weight /= weights;
    return samples;
}

const LayerTexture* layer_of(std::span<const LayerTexture> layers, LayerRole role) {
    const auto found = std::ranges::find(layers, role, &LayerTexture::role);
    return found == layers.end() ? nullptr : &*found;
}

double stored(const LayerTexture& layer, std::size_t sample) {
    return std::to_integer<int>(layer.texels[sample]) / 255.0;
}

} // namespace

std::vector<double> environment_lobes(std::span<const LayerTexture> material) {
    // Most roughness: readers use the layer up to 0.4, but other surfaces than metals reflect so little
    // that it is seldom worth its bytes.
    constexpr double smooth = 0.2, smooth_metal = 0.305, metal = 0.3;
    constexpr double least_share = 0.1; // of the reflectance
    constexpr double aslant = 0.25;     // sharper lobes are seen where cosines are below 1/16
    const LayerTexture* const specular = layer_of(material, LayerRole::specular);
    const LayerTexture* const roughness = layer_of(material, LayerRole::roughness);
    if (specular == nullptr || roughness == nullptr)
        return {};
    double all = 0, sharp = 0, least = 1, most = 0;
    for (std::size_t i = 0; i < roughness->texels.size(); ++i) {
        if (roughness->mask[i] == std::byte{0})
            continue;
        const double r = stored(*roughness, i);
        const double reflects =
            srgb_to_linear(std::max({stored(*specular, 3 * i), stored(*specular, 3 * i + 1),
                                     stored(*specular, 3 * i + 2)}));
        all += reflects;
        if (r > (reflects > metal ? smooth_metal : smooth))
            continue;
        sharp += reflects;
        least = std::min(least, r);
        most = std::max(most, r);
    }
    if (!(sharp > least_share * all))
        return {};
    constexpr double rounded = 0.95; // roughness has 8 bits
    if (rounded * most <= first_lobe)
        return {most}; // a single lobe may be sharper than the first of several
    std::vector<double> lobes{first_lobe};
    while (lobes.back() < rounded * most)
        lobes.push_back(2.0 * lobes.back());
    // Those that nobody sees cost least if they are as others.
    for (std::size_t k = lobes.size() - 1; k-- > 0;)
        if (lobes[k] < aslant * least)
            lobes[k] = lobes[k + 1];
    return lobes;
}

Result<LayerTexture> bake_environment_layer(const Environment& environment,
                                            std::span<const double> roughnesses,
                                            const EnvironmentLayerOptions& options,
                                            const BakeRun& run) {
    const std::uint32_t side = options.directions;
    const auto lobes = static_cast<std::uint32_t>(roughnesses.size());
    const Extent4 whole{lobes, 1, side, side};
    LayerTexture texture = make_layer(LayerRole::environment, whole, 3);
    texture.mask.assign(texture.mask.size(), std::byte{1});
    texture.tile = {lobes, 1, std::min(side, 32u), std::min(side, 32u)};
    const EnvironmentMips mips(environment);
    std::vector<std::vector<LobeSample>> samples;
    for (const double roughness : roughnesses)
        samples.push_back(samples_of(mips, roughness));
    LightTexels seen(texel_count(whole), glm::vec3(0.0f));
    TESSERA_TRY(for_rows("baking the environment", side, run, [&](std::uint32_t t) {
        for (std::uint32_t s = 0; s < side; ++s) {
            // About a normal that is the direction itself, the mirrored direction is that one, too.
            const SurfaceFrame any = surface_frame({0.0, 0.0, 1.0});
            const glm::dvec3 seen_at = octahedral_direction(AngularMap::octahedral_mirrored, any,
                                                            (s + 0.5) / side, (t + 0.5) / side);
            const glm::dvec3 z = 2.0 * glm::dot(seen_at, any.ez) * any.ez - seen_at;
            const glm::dvec3 x = any_tangent(z), y = glm::cross(z, x);
            for (std::uint32_t lobe = 0; lobe < lobes; ++lobe) {
                glm::dvec3 sum(0.0);
                for (const LobeSample& sample : samples[lobe]) {
                    const glm::dvec3& l = sample.direction;
                    sum += sample.weight * mips.light(x * l.x + y * l.y + z * l.z, sample.mip);
                }
                seen[(std::size_t{lobe} * side + t) * side + s] = glm::vec3(sum * options.exposure);
            }
        }
    }));
    store_wide_light(texture, seen, most_environment);
    return texture;
}

} // namespace tessera::corpus
