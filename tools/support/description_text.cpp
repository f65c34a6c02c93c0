#include "tools/support/description_text.h"

#include "tools/support/parse.h"
#include "tools/support/suggestions.h"

#include <cmath>
#include <cstdio>
#include <optional>
#include <span>
#include <vector>

namespace tessera {
namespace {

constexpr float usual_sphere_radius = 3.5f; // the sphere of the built-in scenes

template <NamedEnum Enum> std::string all_names() {
    std::string text;
    for (const char* name : value_names<Enum>)
        text += (text.empty() ? "" : ", ") + std::string(name);
    return text;
}

template <NamedEnum Enum>
Status set_by_name(Enum& out, std::string_view field, const std::string& text) {
    if (const std::optional<Enum> value = parse_value<Enum>(text)) {
        out = *value;
        return {};
    }
    return {ErrorCode::bad_argument,
            std::string(field) + " '" + text + "' is not one of: " + all_names<Enum>() +
                did_you_mean(text, {value_names<Enum>.begin(), value_names<Enum>.end()})};
}

// Parses out.size() numbers. Their own text is accepted, too, so they are checked after rounding.
bool parse_floats(std::string_view text, std::span<float> out) {
    constexpr float largest = 1e30f;
    std::vector<double> numbers(out.size());
    if (!parse_numbers(text, numbers))
        return false;
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (std::abs(numbers[i]) > 2.0 * largest) // before it can overflow
            return false;
        out[i] = static_cast<float>(numbers[i]);
        if (std::abs(out[i]) > largest)
            return false;
    }
    return true;
}

void set_sphere(Description& d, Proxy proxy, const float (&sphere)[4]) {
    d.proxy = proxy;
    for (int i = 0; i < 3; ++i)
        d.sphere_centre[i] = sphere[i];
    d.sphere_radius = sphere[3];
}

Status set_proxy(Description& d, const std::string& text) {
    if (text == "none") {
        set_sphere(d, Proxy::none, {0, 0, 0, 0});
        return {};
    }
    if (text == "sphere") {
        set_sphere(d, Proxy::sphere, {0, 0, 0, usual_sphere_radius});
        return {};
    }
    float sphere[4];
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    if ((kind != "sphere" && kind != "sphere-inside") || colon == std::string::npos ||
        !parse_floats(std::string_view(text).substr(colon + 1), sphere) || sphere[3] <= 0)
        return {ErrorCode::bad_argument, "proxy '" + text + "' is not " +
                                             description_field_values("proxy") +
                                             ", with r above 0"};
    set_sphere(d, kind == "sphere" ? Proxy::sphere : Proxy::sphere_inside, sphere);
    return {};
}

std::string float_text(float value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", static_cast<double>(value));
    return text;
}

} // namespace

std::string description_field_values(std::string_view field) {
    if (field == "proxy")
        return "none, sphere, sphere:cx,cy,cz,r, sphere-inside:cx,cy,cz,r";
    if (field == "surface-map")
        return all_names<SurfaceMap>();
    if (field == "angular-map")
        return all_names<AngularMap>();
    if (field == "transfer")
        return all_names<Transfer>();
    if (field == "primaries")
        return all_names<Primaries>();
    if (field == "alpha")
        return all_names<AlphaMode>();
    return "near,far: distances of the observer from the centre";
}

Status set_description_field(Description& d, std::string_view field, const std::string& text) {
    if (field == "proxy")
        return set_proxy(d, text);
    if (field == "surface-map")
        return set_by_name(d.surface_map, field, text);
    if (field == "angular-map")
        return set_by_name(d.angular_map, field, text);
    if (field == "transfer")
        return set_by_name(d.transfer, field, text);
    if (field == "primaries")
        return set_by_name(d.primaries, field, text);
    if (field == "alpha")
        return set_by_name(d.alpha, field, text);
    float radius[2];
    if (field == "viewing-radius" && parse_floats(text, radius) && radius[0] >= 0 &&
        radius[0] <= radius[1]) {
        d.viewing_radius[0] = radius[0];
        d.viewing_radius[1] = radius[1];
        return {};
    }
    return {ErrorCode::bad_argument,
            std::string(field) + " '" + text + "' is not near,far with 0 <= near <= far"};
}

std::map<std::string, std::string> description_to_text(const Description& d) {
    std::map<std::string, std::string> text;
    if (is_sphere(d.proxy))
        text["proxy"] = (d.proxy == Proxy::sphere ? "sphere:" : "sphere-inside:") +
                        float_text(d.sphere_centre[0]) + "," + float_text(d.sphere_centre[1]) +
                        "," + float_text(d.sphere_centre[2]) + "," + float_text(d.sphere_radius);
    if (d.surface_map != SurfaceMap::none)
        text["surface-map"] = name_of(d.surface_map);
    if (d.angular_map != AngularMap::none)
        text["angular-map"] = name_of(d.angular_map);
    if (d.transfer != Transfer::unspecified)
        text["transfer"] = name_of(d.transfer);
    if (d.primaries != Primaries::unspecified)
        text["primaries"] = name_of(d.primaries);
    if (d.alpha != AlphaMode::none)
        text["alpha"] = name_of(d.alpha);
    if (d.viewing_radius[0] != 0 || d.viewing_radius[1] != 0)
        text["viewing-radius"] =
            float_text(d.viewing_radius[0]) + "," + float_text(d.viewing_radius[1]);
    return text;
}

} // namespace tessera
