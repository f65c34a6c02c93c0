#include "corpus/catalog.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

constexpr glm::dvec3 x_axis{1.0, 0.0, 0.0};
constexpr glm::dvec3 y_axis{0.0, 1.0, 0.0};
constexpr glm::dvec3 z_axis{0.0, 0.0, 1.0};

Material flat(const glm::dvec3& colour) {
    return {.colour = colour, .specular = 2.0 / 3.0};
}

Material patterned(Pattern pattern, double cells, const glm::dvec3& colour,
                   const glm::dvec3& colour2, double grain = 0.0) {
    return {
        .colour = colour, .colour2 = colour2, .pattern = pattern, .cells = cells, .grain = grain};
}

Material mirrored(double share, const glm::dvec3& colour) {
    Material material = flat(colour);
    material.mirror = share;
    return material;
}

Material glowing(const glm::dvec3& emission) {
    return {.colour = glm::dvec3{0.0}, .emission = emission};
}

// The objects of the paper. No shadows: the purple cylinder would darken the whole white sphere.
Scene composed() {
    Scene scene;
    scene.objects = {
        sphere({0, 0, 0}, 0.5, flat({0.95, 0.95, 0.95})),
        sphere({0, 0, -1.87}, 0.5, flat({0.9, 0.05, 0.05})),
        cylinder({2.62, 0, 0}, 0.5, 2, flat({0.5, 0.05, 0.55})),
        turned(cylinder({-1.07, -0.41, 1.81}, 0.5, 2, flat({0.05, 0.1, 0.9})), x_axis, 90),
        cylinder({0.87, 0.76, 2.06}, 0.5, 2, flat({0.03, 0.03, 0.03})),
        box({-1.2, 0.71, -0.68}, {1, 1, 1}, flat({0.05, 0.75, 0.1})),
        box({1.47, -1.05, 0.93}, {1, 1, 1}, flat({0.95, 0.9, 0.05})),
    };
    return scene;
}

Scene aliasing(double x) {
    Scene scene;
    scene.objects = {cylinder({x, 0, 0}, 0.5, 2, flat({0.5, 0.05, 0.55}))};
    return scene;
}
Scene aliasing_near() {
    return aliasing(2);
}
Scene aliasing_far() {
    return aliasing(-5);
}

// A closed room around the window: no ray misses, and no surface is smooth.
Scene gallery() {
    Scene scene;
    scene.shadows = true;
    scene.ambient = 0.55;
    scene.light = {glm::normalize(glm::dvec3{0.5, 0.8, 0.35}), 0.45};
    const glm::dvec3 dark{0.12, 0.1, 0.14};
    scene.objects = {
        turned(plane({-6, 0, 0}, 9, 12,
                     patterned(Pattern::bricks, 2.5, {0.8, 0.78, 0.7}, {0.6, 0.2, 0.12}, 0.4)),
               z_axis, -90),
        turned(plane({6, 0, 0}, 9, 12,
                     patterned(Pattern::tiles, 4, {0.95, 0.9, 0.7}, {0.1, 0.25, 0.5}, 0.3)),
               z_axis, 90),
        turned(plane({0, 0, -6}, 12, 9,
                     patterned(Pattern::checker, 3, {0.9, 0.85, 0.6}, {0.2, 0.35, 0.2}, 0.5)),
               x_axis, 90),
        turned(plane({0, 0, 6}, 12, 9,
                     patterned(Pattern::stripes, 5, {0.9, 0.6, 0.6}, {0.25, 0.1, 0.3}, 0.4)),
               x_axis, -90),
        plane({0, -4.5, 0}, 12, 12, patterned(Pattern::checker, 2, {0.9, 0.9, 0.85}, dark, 0.5)),
        plane({0, 4.5, 0}, 12, 12,
              patterned(Pattern::noise, 3, {0.95, 0.95, 1.0}, {0.05, 0.15, 0.4}, 0.6)),
        sphere({1.1, 0.9, 0.4}, 0.9,
               patterned(Pattern::checker, 6, {0.95, 0.9, 0.2}, {0.6, 0.05, 0.1}, 0.2)),
        turned(box({-1.3, -0.6, 0.8}, {1.6, 1.6, 1.6},
                   patterned(Pattern::bricks, 7, {0.9, 0.9, 0.9}, {0.2, 0.5, 0.6}, 0.5)),
               glm::normalize(glm::dvec3{1, 2, 0.5}), 35),
        cylinder({0.2, -0.8, -1.6}, 0.6, 2.6,
                 patterned(Pattern::stripes, 8, {0.95, 0.95, 0.9}, {0.1, 0.4, 0.15}, 0.4)),
        sphere({-1.2, 1.4, -1.1}, 0.7,
               patterned(Pattern::noise, 8, {0.0, 0.1, 0.5}, {1.0, 0.95, 0.8})),
        turned(cylinder({1.2, -1.6, 1.4}, 0.35, 2.2,
                        patterned(Pattern::tiles, 9, {0.9, 0.4, 0.1}, {0.1, 0.1, 0.2}, 0.3)),
               z_axis, 65),
    };
    for (std::size_t i = 0; i < 6; ++i) // otherwise the room would keep its light out
        scene.objects[i].casts_shadow = false;
    return scene;
}

// A mirror ball among textured objects. Its reflections move with the observer at every place.
Scene mirror() {
    Scene scene;
    scene.shadows = true;
    scene.ambient = 0.35;
    scene.light = {glm::normalize(glm::dvec3{0.6, 0.9, 0.5}), 0.65};
    scene.background = {0.55, 0.7, 0.9};
    scene.objects = {
        sphere({0, 0, 0}, 1.2, mirrored(0.9, {0.9, 0.9, 0.9})),
        plane({0, -1.5, 0}, 7, 7,
              patterned(Pattern::checker, 2, {0.9, 0.9, 0.9}, {0.15, 0.15, 0.2}, 0.2)),
        turned(box({-1.9, -0.7, 0.9}, {1, 1.5, 1},
                   patterned(Pattern::bricks, 5, {0.85, 0.8, 0.75}, {0.65, 0.25, 0.15}, 0.3)),
               y_axis, 30),
        cylinder({1.7, -0.5, 1.2}, 0.45, 2,
                 patterned(Pattern::stripes, 6, {0.95, 0.9, 0.3}, {0.15, 0.3, 0.6})),
        sphere({0.4, -0.8, -2.1}, 0.7,
               patterned(Pattern::noise, 5, {0.8, 0.15, 0.1}, {1.0, 0.9, 0.6})),
        sphere({-1.1, 1.3, -1.4}, 0.5, mirrored(0.6, {0.9, 0.6, 0.2})),
        turned(box({2.0, 0.9, -1.0}, {0.8, 0.8, 0.8},
                   patterned(Pattern::tiles, 6, {0.1, 0.5, 0.3}, {0.9, 0.95, 0.7})),
               x_axis, 40),
    };
    return scene;
}

// Scene-linear light over seven decades: a moonlit room with lamps, one of them very bright.
Scene lamps() {
    Scene scene;
    scene.type = SampleType::half16;
    scene.shadows = true;
    scene.lamps_shine = true;
    scene.ambient = 0.015;
    scene.light = {glm::normalize(glm::dvec3{-0.4, 0.8, 0.5}), 0.01};
    scene.background = {0.001, 0.0012, 0.002};
    scene.objects = {
        sphere({1.2, 1.1, 0.9}, 0.16, glowing({10000, 9000, 7000})),
        sphere({-1.6, 0.4, 1.3}, 0.2, glowing({40, 90, 400})),
        sphere({0.3, -0.9, -1.8}, 0.22, glowing({30, 6, 0.8})),
        sphere({-1.5, 1.5, -1.2}, 0.3, glowing({0.9, 1.4, 0.5})),
        plane({0, -1.7, 0}, 6, 6,
              patterned(Pattern::checker, 1.5, {0.8, 0.8, 0.8}, {0.1, 0.1, 0.1}, 0.3)),
        turned(box({0.1, -0.9, 0.6}, {1.2, 1.2, 1.2}, flat({0.7, 0.5, 0.4})), y_axis, 25),
        cylinder({1.7, -0.7, -0.8}, 0.4, 2, mirrored(0.5, {0.6, 0.6, 0.6})),
        sphere({-1.3, -0.9, -0.5}, 0.7,
               patterned(Pattern::noise, 4, {0.9, 0.9, 0.9}, {0.2, 0.3, 0.5})),
    };
    return scene;
}

// The colour of the window itself, which a 2D texture could hold.
Scene lambert() {
    Scene scene;
    scene.painted = true;
    scene.paint = patterned(Pattern::bricks, 2, {0.92, 0.9, 0.85}, {0.75, 0.3, 0.15}, 0.7);
    return scene;
}

// Thin blades seen edge-on, rods through the poles, sparks of one texel, objects on the window.
Scene hard() {
    Scene scene;
    scene.shadows = true;
    scene.ambient = 0.05;
    scene.light = {glm::normalize(glm::dvec3{1.0, 0.3, 0.2}), 0.95};
    scene.background = glm::dvec3{0.0};
    const Material white = flat({1, 1, 1});
    for (int i = 0; i < 12; ++i) {
        const double angle = i * 15.0;
        scene.objects.push_back(turned(box({0, 0, 0}, {2.4, 0.8, 0.002}, white), y_axis, angle));
    }
    for (int i = 0; i < 32; ++i) { // sparks on a golden spiral
        const double height = 2.9 * ((2.0 * i + 1.0) / 32.0 - 1.0);
        const double angle = i * 2.399963229728653;
        const double radius = std::sqrt(3.0 * 3.0 - height * height);
        Material spark = glowing({1, 1, 1});
        if (i % 3 == 1)
            spark.emission = {1, 0.1, 0};
        scene.objects.push_back(
            sphere({radius * std::sin(angle), height, radius * std::cos(angle)}, 0.012, spark));
    }
    const Material fine = patterned(Pattern::checker, 25, {1, 1, 1}, {0, 0, 0});
    scene.objects.insert(
        scene.objects.end(),
        {
            cylinder({0, 0, 0}, 0.02, 9, flat({0.1, 1, 0.1})), // along the axis, through both poles
            sphere({0, 3.2, 0}, 0.25, fine),
            sphere({0, -3.2, 0}, 0.25, flat({1, 0, 0})),
            plane({0, -1.2, 0}, 3, 3, fine),
            sphere({3.2, 0, 0}, 0.3, flat({0, 0.3, 1})), // touches the window from inside
            sphere({-3.5, 0, 0}, 0.3, flat({1, 1, 0})),  // half outside: some rays start inside
            sphere({0, 0.4, -30}, 6, fine),              // far behind, finer than any texel
            turned(box({0, 1.6, 0}, {5, 0.001, 0.4}, white), z_axis, 3),
        });
    return scene;
}

struct Entry {
    const char* name;
    const char* description;
    Scene (*make)();
    SampleType type = SampleType::unorm8;
    Extent4 default_size{512, 256, 32, 32};
};

constexpr Extent4 aliasing_size{1024, 512, 32, 32};

constexpr Entry catalog[] = {
    {"composed", "the paper's scene: two spheres, three cylinders, two cubes", composed},
    {"aliasing-near", "the paper's cylinder at (2,0,0), close to the surface", aliasing_near,
     SampleType::unorm8, aliasing_size},
    {"aliasing-far", "the paper's cylinder at (-5,0,0), beyond the far side", aliasing_far,
     SampleType::unorm8, aliasing_size},
    {"gallery", "a closed room, fine textures everywhere, no empty texel", gallery},
    {"mirror", "a mirror ball among textured objects", mirror},
    {"lamps", "lamps in a dark room, scene-linear from 1e-3 to 1e4", lamps, SampleType::half16},
    {"lambert", "a painted surface, the same from every direction", lambert},
    {"hard", "numerically hard: edge-on blades, sparks, rods through the poles", hard},
};

SceneInfo info_of(const Entry& entry) {
    return {entry.name, entry.description, entry.type, entry.default_size};
}

// What to do with a model of a kind that is not read; empty for other names.
std::string other_model_hint(const std::string& name) {
    for (const char* ending : {".stl", ".usd", ".usda", ".usdc", ".usdz", ".fbx", ".dae", ".3ds",
                               ".blend", ".x3d", ".abc", ".ifc", ".step"}) {
        const std::string suffix = ending;
        const auto same = [](char a, char b) {
            return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
        };
        if (name.size() > suffix.size() &&
            std::equal(suffix.begin(), suffix.end(),
                       name.end() - static_cast<std::ptrdiff_t>(suffix.size()),
                       [&](char b, char a) { return same(a, b); }))
            return suffix + " models are not read; convert the model to glTF (.glb), for example "
                            "with Blender";
    }
    return {};
}

Result<const Entry*> find_entry(const std::string& name) {
    std::string known;
    for (const Entry& entry : catalog) {
        if (name == entry.name)
            return &entry;
        known += (known.empty() ? "" : ", ") + std::string(entry.name);
    }
    const std::string hint = other_model_hint(name);
    if (!hint.empty())
        return Status{ErrorCode::unsupported, name + ": " + hint};
    return Status{ErrorCode::bad_argument, "there is no scene '" + name + "'; there are " + known};
}

} // namespace

std::vector<SceneInfo> scenes() {
    std::vector<SceneInfo> result;
    for (const Entry& entry : catalog)
        result.push_back(info_of(entry));
    return result;
}

Result<SceneInfo> find_scene(const std::string& name) {
    TESSERA_TRY_ASSIGN(const Entry* entry, find_entry(name));
    return info_of(*entry);
}

Result<Scene> make_scene(const std::string& name) {
    TESSERA_TRY_ASSIGN(const Entry* entry, find_entry(name));
    return entry->make();
}

} // namespace tessera::corpus
