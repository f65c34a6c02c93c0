#include "tools/verbs/bake_models.h"

#include "corpus/model_surface/model_source.h"
#include "tools/support/option_checks.h"
#include "tools/support/parse.h"
#include "tools/texture_io/baked_surface.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <thread>

namespace tessera {
namespace {

// Diffuse light is found once a place, by this many times the paths of a texel.
constexpr unsigned diffuse_share = 16;
constexpr unsigned noise_trials = 200;
constexpr corpus::Texels2 usual_directions{16, 16};
constexpr Extent4 usual_tile{32, 32, 8, 8};
// Of white in the mean light of all directions, as light on the display.
constexpr double usual_brightness = 0.6;

Result<corpus::Sun> parse_sun(const std::string& text) {
    glm::dvec3 d(0.0);
    char rest = 0;
    if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &d.x, &d.y, &d.z, &rest) != 3 ||
        !(glm::length(d) > 1e-9) || !(glm::length(d) < 1e9))
        return Status(ErrorCode::bad_argument,
                      "--light: '" + text + "' is not x,y,z, the way to a sun");
    return corpus::Sun{glm::normalize(d), glm::dvec3(3.0)};
}

Result<corpus::ModelLight> make_light(const ModelArguments& a) {
    corpus::ModelLight light;
    if (!a.environment.empty()) {
        TESSERA_TRY_ASSIGN(corpus::Environment environment,
                           corpus::Environment::load(a.environment));
        light.environment = std::make_shared<const corpus::Environment>(std::move(environment));
    } else {
        light.environment =
            std::make_shared<const corpus::Environment>(corpus::Environment::studio());
    }
    if (!a.light.empty()) {
        TESSERA_TRY_ASSIGN(light.sun, parse_sun(a.light));
    }
    return light;
}

double usual_exposure(const corpus::ModelLight& light) {
    constexpr unsigned trials = 4096;
    double mean = 0;
    for (unsigned i = 0; i < trials; ++i) {
        corpus::PathRandom random(0, i);
        const corpus::LightSample s = light.environment->sample(random.next2());
        mean += glm::dot(s.light, {0.2126, 0.7152, 0.0722}) / s.density /
                (4.0 * std::numbers::pi * trials);
    }
    if (light.sun)
        mean += light.sun->irradiance.y / (4.0 * std::numbers::pi);
    return mean > 0.0 ? usual_brightness / mean : 1.0;
}

void change_materials(const ModelArguments& a, corpus::Model& model) {
    for (corpus::ModelMaterial& m : model.materials) {
        if (a.roughness)
            m.roughness = *a.roughness;
        if (a.metal)
            m.metal = *a.metal;
        if (a.roughness || a.metal)
            m.metal_roughness_texture.image = -1;
    }
}

Status check_model(const BakeCommand& a) {
    if (!a.texture.size.empty())
        return {ErrorCode::bad_argument,
                "--size: a model's size comes from --density and --directions"};
    if (a.encode.description.contains("surface-map"))
        return {ErrorCode::bad_argument, "--surface-map: a mesh has its own"};
    if (!is_compressed(a))
        return {ErrorCode::bad_argument,
                a.output + ": a model needs a .tess output, which holds the mesh"};
    return {};
}

} // namespace

void add_model_options(CLI::App& app, ModelArguments& a) {
    app.add_option("--env", a.environment,
                   "Model: light from all around, an .exr or .hdr of longitude and latitude "
                   "(default: a studio)");
    app.add_option("--light", a.light, "Model: a sun towards x,y,z, beside that");
    app.add_option("--exposure", a.exposure,
                   "Model: what light is multiplied by for the display (default: white in the mean "
                   "light becomes 0.6)")
        ->check(number_between(1e-6, 1e6));
    app.add_option("--roughness", a.roughness, "Model: of all its materials")
        ->check(number_between(0, 1));
    app.add_option("--metal", a.metal, "Model: of all its materials")->check(number_between(0, 1));
}

Status check_no_model_options(const ModelArguments& a) {
    for (const auto& [option, given] :
         {std::pair("--env", !a.environment.empty()), std::pair("--light", !a.light.empty()),
          std::pair("--exposure", a.exposure.has_value()),
          std::pair("--roughness", a.roughness.has_value()),
          std::pair("--metal", a.metal.has_value())})
        if (given)
            return {ErrorCode::bad_argument,
                    std::string(option) + ": needs a model; built-in scenes have their own"};
    return {};
}

Result<Baking> model_baking(const BakeCommand& a, const std::string& map) {
    TESSERA_TRY(check_model(a));
    TESSERA_TRY_ASSIGN(const corpus::SurfaceWish wish, surface_wish(a));
    TESSERA_TRY_ASSIGN(
        const auto wished_map,
        parse_octahedral_map(map.empty() ? "auto" : map).with_context("--angular-map"));
    const AngularMap chosen = wished_map.value_or(AngularMap::octahedral_mirrored);
    TESSERA_TRY_ASSIGN(corpus::Model model, corpus::load_model(a.scene));
    change_materials(a.model, model);
    TESSERA_TRY_ASSIGN(const corpus::ModelLight light, make_light(a.model));
    TESSERA_TRY_ASSIGN(model, corpus::with_both_sides(std::move(model)).with_context(a.scene));
    const Extent4 tile = wish.tile.value_or(usual_tile);
    const corpus::Texels2 directions = wish.directions.value_or(usual_directions);
    corpus::ModelAtlasOptions options;
    options.density = wish.density.value_or(0.0);
    options.tile = {tile[axis_u], tile[axis_v]};
    TESSERA_TRY_ASSIGN(corpus::ModelAtlas atlas,
                       corpus::make_model_atlas(model, options).with_context(a.scene));
    Baking baking;
    baking.mesh = atlas.stream;
    const std::size_t triangles = atlas.mesh.triangles.size(), charts = atlas.charts.size();
    const double density = atlas.density;
    corpus::LitModelOptions paths;
    paths.samples = a.samples;
    paths.diffuse_samples = std::min(65536u, a.samples * diffuse_share);
    paths.seed = a.seed.value_or(1);
    paths.threads = a.texture.threads != 0 ? a.texture.threads
                                           : std::max(1u, std::thread::hardware_concurrency());
    TESSERA_TRY_ASSIGN(const auto lit, corpus::LitModel::make(std::move(atlas), light, paths));
    const corpus::Display display{a.model.exposure.value_or(usual_exposure(light)),
                                  SampleType::unorm8};
    TESSERA_TRY_ASSIGN(baking.texels, corpus::make_model_source(lit, chosen, directions, display));
    baking.mask = corpus::make_model_mask(lit, chosen, directions);
    const corpus::NoiseEstimate noise =
        corpus::estimate_noise(*lit, chosen, directions, display, a.samples, noise_trials);
    baking.description.proxy = Proxy::mesh;
    baking.description.surface_map = SurfaceMap::mesh_uv;
    baking.description.angular_map = chosen;
    baking.description.transfer = Transfer::srgb;
    baking.description.primaries = Primaries::bt709;
    baking.tile = tile;
    const std::string exposure = format_number(display.exposure, 4);
    baking.facts = {{"model", a.scene},
                    {"samples per texel", std::to_string(a.samples)},
                    {"seed", std::to_string(paths.seed)},
                    {"texels per unit", format_number(density, 3)},
                    {"environment", a.model.environment.empty() ? "studio" : a.model.environment},
                    {"exposure", exposure}};
    if (!a.model.light.empty())
        baking.facts.emplace_back("sun", a.model.light);
    if (a.model.roughness)
        baking.facts.emplace_back("roughness", format_number(*a.model.roughness, 4));
    if (a.model.metal)
        baking.facts.emplace_back("metal", format_number(*a.model.metal, 4));
    baking.json = {{"model", a.scene},
                   {"samples_per_texel", a.samples},
                   {"texels_per_unit", density},
                   {"angular_map", name_of(chosen)},
                   {"triangles", triangles},
                   {"charts", charts},
                   {"mesh_bytes", baking.mesh.size()},
                   {"exposure", display.exposure},
                   {"noise_db", noise.decibels}};
    baking.remark = std::to_string(triangles) + " triangles in " + human_bytes(baking.mesh.size()) +
                    ", " + std::to_string(charts) + " charts, " + format_number(density, 3) +
                    " texels a unit, " + name_of(chosen) + "; exposure " + exposure +
                    "; noise of chance " + format_number(noise.decibels, 1) +
                    " dB, 50 dB take --spp " + format_number(noise.samples_for(50.0), 0);
    return baking;
}

} // namespace tessera
