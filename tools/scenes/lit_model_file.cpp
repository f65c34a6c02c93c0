#include "tools/scenes/lit_model_file.h"

#include "tools/support/parse.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

namespace tessera {
namespace {

// Linear display value of a white surface under the mean light of all directions.
constexpr double usual_brightness = 0.6;
constexpr const char* studio = "studio"; // the built-in environment

Result<corpus::Sun> parse_sun(const std::string& text) {
    glm::dvec3 d(0.0);
    TESSERA_TRY(parse_point(text, d).with_context("--light"));
    if (!(glm::length(d) > 1e-9) || !(glm::length(d) < 1e9))
        return Status(ErrorCode::bad_argument, "--light: '" + text + "' is not a direction");
    return corpus::Sun{glm::normalize(d), glm::dvec3(3.0)};
}

Result<corpus::ModelLight> make_light(const ModelArguments& a) {
    corpus::ModelLight light;
    light.backdrop = glm::dvec3(0.0); // files of bakes have a black background
    if (!a.environment.empty()) {
        TESSERA_TRY_ASSIGN(corpus::Environment environment,
                           corpus::Environment::load(a.environment, a.environment_layer));
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

// The text of a number in metadata. `render --truth` reads it back, so the computed exposure is
// rounded to it, too.
std::string digits(double value) {
    return format_digits(value, 6);
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
    for (const corpus::ModelLamp& lamp : light.lamps) {
        // A lamp may lie inside the model.
        const double distance = std::max(glm::length(lamp.position), corpus::paper_radius);
        const bool is_far = lamp.kind == corpus::ModelLamp::Kind::directional;
        mean += lamp.strength.y / (is_far ? 1.0 : distance * distance) / (4.0 * std::numbers::pi);
    }
    return mean > 0.0 ? std::strtod(digits(usual_brightness / mean).c_str(), nullptr) : 1.0;
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

} // namespace

Result<LitModelFile> load_lit_model(const std::string& path, const ModelArguments& a) {
    LitModelFile file;
    TESSERA_TRY_ASSIGN(file.model, corpus::load_model(path));
    change_materials(a, file.model);
    TESSERA_TRY_ASSIGN(file.light, make_light(a));
    file.light.lamps = file.model.lamps;
    file.cameras = file.model.cameras;
    file.placement = placement_of(file.model.frame);
    file.display = {a.exposure ? *a.exposure : usual_exposure(file.light), SampleType::unorm8};
    for (corpus::ModelMaterial& m : file.model.materials)
        m.unlit_light = 1.0 / file.display.exposure; // so that it shows its base colour
    return file;
}

std::vector<std::pair<std::string, std::string>> facts_of(const ModelArguments& a,
                                                          const LitModelFile& file) {
    std::vector<std::pair<std::string, std::string>> facts = {
        {"environment", a.environment.empty() ? studio : a.environment},
        {"exposure", digits(file.display.exposure)}};
    if (!a.environment_layer.empty())
        facts.emplace_back("environment layer", a.environment_layer);
    if (!a.light.empty())
        facts.emplace_back("sun", a.light);
    if (a.roughness)
        facts.emplace_back("roughness", digits(*a.roughness));
    if (a.metal)
        facts.emplace_back("metal", digits(*a.metal));
    return facts;
}

Result<ModelArguments> arguments_in(const Metadata& metadata) {
    const auto text = [&](const char* key) {
        const auto said = metadata.find(key);
        return said == metadata.end() ? std::string() : said->second;
    };
    ModelArguments a{.environment = text("Environment"),
                     .environment_layer = text("Environment layer"),
                     .light = text("Sun"),
                     .exposure = {},
                     .roughness = {},
                     .metal = {}};
    if (a.environment == studio)
        a.environment.clear();
    for (const auto& [key, value] :
         {std::pair("Exposure", &a.exposure), std::pair("Roughness", &a.roughness),
          std::pair("Metal", &a.metal)})
        if (const std::string number = text(key); !number.empty()) {
            double x = 0;
            if (!parse_number(number, x) || !std::isfinite(x))
                return Status(ErrorCode::invalid_file, std::string("the metadata key ") + key +
                                                           " is not a number: '" + number + "'");
            *value = x;
        }
    return a;
}

} // namespace tessera
