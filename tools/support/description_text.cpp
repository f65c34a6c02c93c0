#include "tools/support/description_text.h"

#include "tools/support/parse.h"
#include "tools/support/suggestions.h"

#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

namespace tessera {
namespace {

constexpr float usual_sphere_radius = 3.5f; // the sphere of the built-in scenes

template <NamedEnum Enum> std::vector<std::string> names_of() {
    return {value_names<Enum>.begin(), value_names<Enum>.end()};
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words)
        text += (text.empty() ? "" : ", ") + word;
    return text;
}

// Sets `out` to the value named `text`.
template <NamedEnum Enum>
Status set_by_name(Enum& out, std::string_view field, const std::string& text) {
    const std::optional<Enum> value = parse_value<Enum>(text);
    if (!value)
        return {ErrorCode::bad_argument, std::string(field) + " '" + text +
                                             "' is not one of: " + joined(names_of<Enum>()) +
                                             did_you_mean(text, names_of<Enum>())};
    out = *value;
    return {};
}

bool parse_floats(std::string_view text, float* out, int count) {
    constexpr float largest = 1e30f;
    for (int i = 0; i < count; ++i) {
        const std::size_t comma = text.find(',');
        double value = 0;
        if ((comma == std::string_view::npos) != (i == count - 1) ||
            !parse_number(text.substr(0, comma), value) || std::abs(value) > 2.0 * largest)
            return false;
        out[i] = static_cast<float>(value);
        if (std::abs(out[i]) > largest) // after rounding, so that its own text is accepted, too
            return false;
        text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
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
        !parse_floats(std::string_view(text).substr(colon + 1), sphere, 4) || sphere[3] <= 0)
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
        return joined(names_of<SurfaceMap>());
    if (field == "angular-map")
        return joined(names_of<AngularMap>());
    if (field == "transfer")
        return joined(names_of<Transfer>());
    if (field == "primaries")
        return joined(names_of<Primaries>());
    if (field == "alpha")
        return joined(names_of<AlphaMode>());
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
    if (field == "viewing-radius" && parse_floats(text, radius, 2) && radius[0] >= 0 &&
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
