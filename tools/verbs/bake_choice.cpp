#include "tools/verbs/bake_choice.h"

#include "corpus/layers/distant_lights.h"
#include "corpus/layers/layer_density.h"
#include "corpus/layers/layer_trial.h"
#include "corpus/layers/model_layers.h"
#include "corpus/layers/sharp_reflections.h"
#include "corpus/model_surface/model_atlas.h"
#include "tools/support/parse.h"
#include "tools/verbs/bake_layers.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

namespace tessera {
namespace {

// Below, one texture shows the model better (tests/regression/models.md).
constexpr double least_trial = 20; // dB

// Figures for estimates, from the models of that page.
constexpr double bytes_per_triangle = 1.8;
constexpr double bytes_per_texel = 0.22; // of layers, with pictures
constexpr double bytes_per_place = 0.9;  // of one texture, times the root of its directions
constexpr double plain_share = 0.5;      // of these bytes, without pictures
constexpr double texel_seconds = 60e-6;  // for all that is not a path, of layers

std::optional<double> texels_asked(const BakeCommand& a, const corpus::Model& model) {
    if (!a.density)
        return a.texels;
    const double density = *a.density / model.frame.scale;
    return corpus::surface_area(model) * density * density;
}

// As corpus::bake_model_layers() and corpus::LitModel trace their paths.
void estimate(const BakeCommand& a, const corpus::Model& model, double path_seconds,
              BakeChoice& choice) {
    const unsigned threads = threads_of(a);
    const double samples = a.samples;
    double own = 0; // bytes of texels
    if (choice.layered) {
        const corpus::LayerDensity density = corpus::layer_density(model, texels_asked(a, model));
        const double texels = density.texels;
        const corpus::ReflectionLayout mirrored = corpus::ModelMirrors(model).layout(texels);
        const double cell = mirrored.texel, place = density.light_texel;
        const double directions = static_cast<double>(mirrored.directions) * mirrored.directions;
        // At most: the number of lights is chosen while baking.
        const double paths =
            texels / (place * place) *
                (4 * samples + 2.0 * a.lights.value_or(corpus::DistantLights::most)) +
            texels / (cell * cell) * directions * 4 * samples / mirrored.fewer_paths;
        choice.seconds = (paths * path_seconds + texels * texel_seconds) / threads;
        own = texels * bytes_per_texel;
    } else {
        const auto wish = surface_wish(a);
        const corpus::Texels2 directions =
            wish.ok() ? wish->directions.value_or(usual_directions) : usual_directions;
        const double all = static_cast<double>(directions[0]) * directions[1];
        const double places = texels_asked(a, model).value_or(corpus::ModelAtlasOptions().texels);
        choice.seconds = places * (16 * samples + 128 + all * samples) * path_seconds / threads;
        own = places * bytes_per_place * std::sqrt(all);
    }
    const bool has_pictures =
        std::ranges::any_of(model.images, [](const corpus::Image& i) { return !i.texels.empty(); });
    choice.bytes = static_cast<double>(model.triangles.size()) * bytes_per_triangle +
                   own * (has_pictures ? 1.0 : plain_share);
    if (a.encode.target_bytes)
        choice.bytes = static_cast<double>(*a.encode.target_bytes);
}

} // namespace

bool speaks(const BakeCommand& a) {
    return !a.texture.quiet && !a.encode.json;
}

unsigned threads_of(const BakeCommand& a) {
    return a.texture.threads != 0 ? a.texture.threads
                                  : std::max(1u, std::thread::hardware_concurrency());
}

std::string option_of_one_texture(const BakeCommand& a) {
    const EncodeArguments& e = a.encode;
    for (const auto& [field, text] : e.description)
        if (field != "proxy" || text != "mesh")
            return "--" + field;
    for (const auto& [option, given] :
         {std::pair("--target-psnr", e.target_psnr.has_value()),
          std::pair("--target-bpt", e.target_bpt.has_value()),
          std::pair("--max-error", e.max_error.has_value()), std::pair("--lossless", e.lossless),
          std::pair("--layers", e.layers), std::pair("--resume", e.resume),
          std::pair("--tile", !e.tile.empty())})
        if (given)
            return option;
    return "";
}

std::string option_of_model_layers(const BakeCommand& a) {
    return a.texels ? "--texels" : a.lights ? "--lights" : a.noise ? "--noise" : "";
}

Result<BakeChoice> choose_layers(const BakeCommand& a, const ModelToBake& model) {
    BakeChoice choice;
    const std::string of_one = option_of_one_texture(a), of_layers = option_of_model_layers(a);
    bool is_asked = true;
    if (a.layered || a.single) {
        choice.layered = a.layered;
        choice.why = a.layered ? "--layered asks for them" : "--single asks for it";
    } else if (!of_one.empty()) {
        choice.layered = false;
        choice.why = of_one + " does not apply to layers";
    } else if (!of_layers.empty()) {
        choice.why = of_layers + " applies to layers only";
    } else {
        is_asked = false;
    }
    if (is_asked && !speaks(a))
        return choice;
    const auto start = std::chrono::steady_clock::now();
    TESSERA_TRY_ASSIGN(const corpus::LayerTrial trial,
                       corpus::try_layers(model.file.model, model.file.light, model.file.display));
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    if (!is_asked) {
        choice.layered = trial.decibels >= least_trial;
        choice.why = "in a trial they hold all light to " + format_number(trial.decibels, 1) +
                     " dB" + (choice.layered ? "" : " only");
        if (!choice.layered)
            choice.why.replace(0, std::string("in a trial they").size(), "in a trial layers");
    }
    estimate(a, model.file.model, seconds.count() / std::max(1.0, static_cast<double>(trial.paths)),
             choice);
    return choice;
}

void say_choice(const BakeCommand& a, const BakeChoice& choice) {
    if (!speaks(a))
        return;
    const std::string cost =
        choice.bytes > 0 ? "; about " + human_bytes(static_cast<std::uint64_t>(choice.bytes)) +
                               " in " + format_number(choice.seconds, 0) + " s"
                         : "";
    std::fprintf(stderr, "tessera bake: %s, because %s%s\n",
                 choice.layered ? "layers" : "one texture", choice.why.c_str(), cost.c_str());
}

} // namespace tessera
