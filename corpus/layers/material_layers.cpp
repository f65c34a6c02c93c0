#include "corpus/layers/material_layers.h"

#include "corpus/trace/path_random.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera::corpus {
namespace {

// Places of a texel at which its material is read.
constexpr std::array<glm::dvec2, 4> material_places{
    {{-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}};
constexpr double most_light = 1.0; // of a display
constexpr std::uint64_t transmission_sequence = 0x74726E73;

struct PlaceMaterial {
    glm::dvec3 diffuse{0.0}, emission{0.0}, specular{0.0};
    double roughness = 0;
    glm::dvec2 normal{0.0}; // in the frame of the mesh
};

// The mean over the texel; nothing if no light is known there.
std::optional<PlaceMaterial> material_of(const ModelPlaces& fine, const PlaceLight& light,
                                         const Tracer& tracer, const NearestLobes& nearest,
                                         std::uint32_t finer, double exposure, std::uint32_t u,
                                         std::uint32_t v) {
    PlaceMaterial sum;
    double lit = 0;
    constexpr double share = 1.0 / material_places.size();
    constexpr unsigned paths_of_place = transmission_paths / material_places.size();
    unsigned next_path = 0; // the places share the paths of one
    for (const glm::dvec2& offset : material_places) {
        ModelSurfacePlace at = fine.place(u, v, offset);
        at.point.opacity = 1.0; // layers hold the light of the surface itself
        const Lobes lobes = nearest(at.point.lobes);
        const glm::dvec2 texel =
            (glm::dvec2(u + 0.5, v + 0.5) + offset) / static_cast<double>(finer);
        if (const auto arriving = light.diffuse(texel, at.chart, at.point.normal)) {
            sum.diffuse += lobes.diffuse * *arriving;
            ++lit;
        }
        sum.emission += share * at.point.emission;
        sum.emission +=
            share * mean_transmitted(tracer, at.point, exposure, next_path, paths_of_place);
        next_path += paths_of_place;
        sum.specular += share * lobes.facing;
        sum.roughness += share * std::sqrt(lobes.alpha);
        sum.normal += share * glm::dvec2(glm::dot(at.point.normal, at.frame.ex),
                                         glm::dot(at.point.normal, at.frame.ey));
    }
    if (lit == 0.0)
        return std::nullopt;
    sum.diffuse /= lit;
    return sum;
}

// The mean of a function of the texel's places, from 0 to 1.
template <class Share>
double mean_over(const ModelPlaces& fine, std::uint32_t u, std::uint32_t v, const Share& share) {
    constexpr int side = 4;
    double sum = 0;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            const glm::dvec2 offset((i + 0.5) / side - 0.5, (j + 0.5) / side - 0.5);
            sum += share(fine.place(u, v, offset).on);
        }
    return sum / (side * side);
}

// The share of the texel that alpha masks leave.
double coverage_of(const ModelPlaces& fine, std::uint32_t u, std::uint32_t v) {
    const RayModel& model = *fine.model();
    return mean_over(fine, u, v, [&](const ModelPlace& place) {
        const std::uint32_t material = model.model().triangles[place.triangle].material;
        const bool is_removed =
            model.model().materials[material].cutoff > 0.0 && model.is_cut_out(place);
        return is_removed ? 0.0 : 1.0;
    });
}

bool is_masked(const Model& model) {
    return std::ranges::any_of(model.triangles, [&](const ModelTriangle& t) {
        return model.materials[t.material].cutoff > 0.0;
    });
}

// The layer of opacity.
Result<LayerTexture> bake_opacity(const ModelPlaces& fine, const BakeRun& run) {
    const Texels2 size = fine.texel_places().size();
    LayerTexture opacity = make_layer(LayerRole::opacity, {size[0], size[1], 1, 1}, 1);
    TESSERA_TRY(for_rows("baking opacity", size[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < size[0]; ++u)
            if (fine.texel_places().matters(u, v))
                store_values(opacity, std::size_t{v} * size[0] + u,
                             {mean_over(fine, u, v, [&](const ModelPlace& place) {
                                 return fine.model()->opacity(place);
                             })});
    }));
    return opacity;
}

// Whether interpolation between a texel and its neighbours shows a surface anywhere.
bool is_visible_around(const LayerTexture& opacity, std::uint32_t u, std::uint32_t v) {
    const std::uint32_t width = opacity.desc.size[axis_u], height = opacity.desc.size[axis_v];
    for (std::uint32_t y = v > 0 ? v - 1 : 0; y <= std::min(v + 1, height - 1); ++y)
        for (std::uint32_t x = u > 0 ? u - 1 : 0; x <= std::min(u + 1, width - 1); ++x)
            if (opacity.texels[std::size_t{y} * width + x] != std::byte{0})
                return true;
    return false;
}

// The quality of emission against the usual one. A display shows little of its errors where diffuse
// light is bright, and what is brighter than white not at all.
double quality_for_emission(const LayerTexture& layer, const LightTexels& emitted,
                            const LightTexels& leaving) {
    constexpr double per_doubling = 8.0; // of the quantiser's step
    constexpr double most_less = 20.0;
    constexpr double error = 1.0 / 64; // of a sample
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < emitted.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c) {
            const auto own = static_cast<double>(emitted[i][c]),
                       other = static_cast<double>(leaving[i][c]);
            if (own <= 0.0)
                continue;
            const double sample = std::max(linear_to_srgb(own / layer.scale) - error, 0.0);
            const double shown = linear_to_srgb(own + other) -
                                 linear_to_srgb(layer.scale * srgb_to_linear(sample) + other);
            squares += std::pow(shown / error, 2);
            ++count;
        }
    const double shown = count > 0.0 ? std::sqrt(squares / count) : 1.0;
    return std::clamp(per_doubling * std::log2(std::max(shown, 1e-6)), -most_less, 0.0);
}

bool needs_emission(const Model& model) {
    return std::ranges::any_of(model.triangles, [&](const ModelTriangle& t) {
        const ModelMaterial& m = model.materials[t.material];
        return is_lamp(m) || m.is_unlit || (m.coats && m.coats->through > 0.0);
    });
}

} // namespace

glm::dvec3 mean_transmitted(const Tracer& tracer, const LitPoint& point, double exposure,
                            unsigned first, unsigned count) {
    if (point.lobes.coats.through == glm::dvec3(0.0))
        return glm::dvec3(0.0);
    glm::dvec3 sum(0.0);
    for (unsigned i = first; i < first + count; ++i) {
        PathRandom random(mix_bits(transmission_sequence), i);
        const glm::dvec3 view = sample_cosine(point.normal, random.next2());
        sum += glm::min(tracer.transmitted(Tracer::facing(point, view), view, random),
                        most_light / exposure);
    }
    return sum / static_cast<double>(count);
}

bool mirrors_light(const Model& model) {
    return std::ranges::any_of(model.triangles, [&](const ModelTriangle& t) {
        return !model.materials[t.material].is_unlit;
    });
}

Result<std::vector<LayerTexture>>
bake_material_layers(const ModelPlaces& fine, const PlaceLight& light, const Tracer& tracer,
                     const NearestLobes& nearest, std::uint32_t finer, double exposure,
                     const BakeRun& run) {
    const Texels2 size = fine.texel_places().size();
    const Extent4 whole{size[0], size[1], 1, 1};
    LayerTexture diffuse = make_layer(LayerRole::diffuse, whole, 3),
                 emission = make_layer(LayerRole::emission, whole, 3),
                 specular = make_layer(LayerRole::specular, whole, 3),
                 roughness = make_layer(LayerRole::roughness, whole, 1),
                 normal = make_layer(LayerRole::normal, whole, 2),
                 coverage = make_layer(LayerRole::coverage, whole, 1);
    const Model& model = fine.model()->model();
    const bool masked = is_masked(model);
    std::optional<LayerTexture> opacity;
    if (fine.model()->has_blending()) {
        TESSERA_TRY_ASSIGN(opacity, bake_opacity(fine, run));
    }
    specular.transfer = Transfer::srgb;
    LightTexels leaving(fine.texels(), glm::vec3(0.0f)), emitted = leaving;
    TESSERA_TRY(for_rows("baking materials", size[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < size[0]; ++u) {
            if (!fine.texel_places().matters(u, v))
                continue;
            const auto m = material_of(fine, light, tracer, nearest, finer, exposure, u, v);
            if (!m)
                continue;
            const std::size_t i = std::size_t{v} * size[0] + u;
            if (masked) {
                const double covered = coverage_of(fine, u, v);
                store_values(coverage, i, {covered});
                if (covered == 0.0)
                    continue; // nobody sees the other layers
            }
            if (opacity && !is_visible_around(*opacity, u, v))
                continue;
            leaving[i] = glm::vec3(m->diffuse * exposure);
            emitted[i] = glm::vec3(m->emission * exposure);
            diffuse.mask[i] = emission.mask[i] = std::byte{1};
            store_values(specular, i,
                         {linear_to_srgb(m->specular.x), linear_to_srgb(m->specular.y),
                          linear_to_srgb(m->specular.z)});
            store_values(roughness, i, {m->roughness});
            store_values(
                normal, i,
                {(128.0 + 127.0 * m->normal.x) / 255.0, (128.0 + 127.0 * m->normal.y) / 255.0});
        }
    }));
    store_light(diffuse, leaving, most_light);
    std::vector<LayerTexture> layers;
    layers.push_back(std::move(diffuse));
    if (masked)
        layers.push_back(std::move(coverage));
    if (opacity)
        layers.push_back(std::move(*opacity));
    if (needs_emission(model)) {
        store_light(emission, emitted, most_light);
        emission.quality_change = quality_for_emission(emission, emitted, leaving);
        layers.push_back(std::move(emission));
    }
    if (mirrors_light(model))
        for (LayerTexture* layer : {&specular, &roughness, &normal})
            layers.push_back(std::move(*layer));
    return layers;
}

} // namespace tessera::corpus
