#include "tools/verbs/scene_estimate.h"

#include "corpus/layers/scene_layers.h"
#include "corpus/shade.h"
#include "corpus/surface/scene_surface.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

// Figures from the built-in scenes at the default quality and effort.
constexpr double mesh_bytes_per_triangle = 2.2;
constexpr double colour_seconds = 5e-6, light_seconds = 0.7e-6; // to encode a texel
// Bytes of a place of each texture, times the root of its directions.
struct CodedBytes {
    double colour, difference, single;
};
constexpr CodedBytes bytes_of_flat{0.008, 0.035, 0.12}, bytes_of_patterns{0.04, 0.15, 0.13};

struct PlacesOfScene {
    double all = 0, shining = 0;
    std::size_t triangles = 0;
};

Result<PlacesOfScene> count_places(const corpus::Scene& scene,
                                   const corpus::SurfaceOptions& layout) {
    TESSERA_TRY_ASSIGN(const corpus::SceneSurface surface,
                       corpus::make_scene_surface(scene, layout));
    PlacesOfScene places{.triangles = surface.mesh.triangles.size()};
    for (const corpus::Chart& chart : surface.charts) {
        const double texels = static_cast<double>(chart.extent[0]) * chart.extent[1];
        places.all += texels;
        if (corpus::shines(scene.objects[chart.object].material))
            places.shining += texels;
    }
    return places;
}

// Of rays that spread evenly over a view of the scene.
double seconds_per_ray(const corpus::Scene& scene) {
    constexpr int side = 64;
    const auto start = std::chrono::steady_clock::now();
    double sum = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const glm::dvec3 eye{10.0, 0.0, 0.0};
            const glm::dvec3 seen{0.0, 7.0 * (y + 0.5) / side - 3.5, 7.0 * (x + 0.5) / side - 3.5};
            sum += corpus::trace_surfaces(scene, {eye, glm::normalize(seen - eye)}).x;
        }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    return std::isfinite(sum) ? seconds.count() / (side * side) : 0.0;
}

} // namespace

Status estimate_scene(const BakeCommand& a, const corpus::Scene& scene,
                      const corpus::SurfaceWish& wish, BakeChoice& choice) {
    const bool has_patterns = std::ranges::any_of(scene.objects, [](const corpus::Object& object) {
        return object.material.pattern != corpus::Pattern::flat;
    });
    const CodedBytes& coded = has_patterns ? bytes_of_patterns : bytes_of_flat;
    double colours = 0, light = 0, coded_light = 0; // texels
    std::size_t triangles = 0;
    if (choice.layered) {
        const corpus::LayerDetail detail = corpus::layer_detail(scene, wish);
        TESSERA_TRY_ASSIGN(const PlacesOfScene places,
                           count_places(scene, corpus::layout_of(detail)));
        const double directions = static_cast<double>(detail.directions[0]) * detail.directions[1];
        triangles = places.triangles;
        colours = places.all * detail.cell * detail.cell;
        light = coded_light = places.shining * directions;
        choice.bytes =
            colours * coded.colour + places.shining * std::sqrt(directions) * coded.difference;
    } else {
        const corpus::SurfaceDetail detail = corpus::surface_detail(scene, wish);
        corpus::SurfaceOptions layout;
        layout.atlas.density = detail.density;
        layout.atlas.tile = {detail.tile[axis_u], detail.tile[axis_v]};
        TESSERA_TRY_ASSIGN(const PlacesOfScene places, count_places(scene, layout));
        const double directions = static_cast<double>(detail.directions[0]) * detail.directions[1];
        triangles = places.triangles;
        colours = places.all - places.shining;
        light = places.shining * directions;
        coded_light = directions > 1.0 ? places.all * directions : 0.0;
        choice.bytes = places.all * std::sqrt(directions) * coded.single;
    }
    const double rays = (colours + light) * a.samples;
    choice.seconds =
        (rays * seconds_per_ray(scene) + colours * colour_seconds + coded_light * light_seconds) /
        threads_of(a);
    choice.bytes += static_cast<double>(triangles) * mesh_bytes_per_triangle;
    if (a.encode.target_bytes)
        choice.bytes = static_cast<double>(*a.encode.target_bytes);
    return {};
}

} // namespace tessera
