#include "tools/support/description_text.h"

#include "tools/support/parse.h"
#include "tools/support/suggestions.h"

#include <cctype>
#include <cmath>
#include <cstdio>
#include <vector>

namespace tessera {
namespace {

// Spelling does not matter: "bt709" is "BT.709", "mesh-uv" is "mesh uv".
std::string normalised(std::string_view text) {
    std::string out;
    for (char c : text)
        if (std::isalnum(static_cast<unsigned char>(c)))
            out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return out;
}

template <class Enum> std::string all_names(int last) {
    std::string names;
    for (int i = 0; i <= last; ++i)
        names += std::string(i > 0 ? ", " : "") + name_of(static_cast<Enum>(i));
    return names;
}

// Sets `out` to the value in first..last whose name is `text`.
template <class Enum>
Status set_by_name(Enum& out, int last, std::string_view field, const std::string& text) {
    std::vector<std::string> names;
    for (int i = 0; i <= last; ++i) {
        const auto value = static_cast<Enum>(i);
        names.emplace_back(name_of(value));
        if (normalised(text) == normalised(name_of(value))) {
            out = value;
            return {};
        }
    }
    return {ErrorCode::bad_argument, std::string(field) + " '" + text + "' is not one of: " +
                                         all_names<Enum>(last) + did_you_mean(text, names)};
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
        if (std::abs(out[i]) > largest) // as a float: its own text, rounded, may say more
            return false;
        text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    }
    return true;
}

Status set_proxy(Description& d, const std::string& text) {
    if (text == "none") {
        d.proxy = Proxy::none;
        d.sphere_radius = d.sphere_centre[0] = d.sphere_centre[1] = d.sphere_centre[2] = 0;
        return {};
    }
    float sphere[4];
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    if ((kind != "sphere" && kind != "sphere-inside") || colon == std::string::npos ||
        !parse_floats(std::string_view(text).substr(colon + 1), sphere, 4) || sphere[3] <= 0)
        return {ErrorCode::bad_argument,
                "proxy '" + text +
                    "' is not none, sphere:cx,cy,cz,r or sphere-inside:cx,cy,cz,r with r above 0"};
    d.proxy = kind == "sphere" ? Proxy::sphere : Proxy::sphere_inside;
    for (int i = 0; i < 3; ++i)
        d.sphere_centre[i] = sphere[i];
    d.sphere_radius = sphere[3];
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
        return "none, sphere:cx,cy,cz,r, sphere-inside:cx,cy,cz,r";
    if (field == "surface-map")
        return all_names<SurfaceMap>(2);
    if (field == "angular-map")
        return all_names<AngularMap>(4);
    if (field == "transfer")
        return all_names<Transfer>(2);
    if (field == "primaries")
        return all_names<Primaries>(1);
    if (field == "alpha")
        return all_names<AlphaMode>(2);
    return "near,far: distances of the observer from the centre";
}

Status set_description_field(Description& d, std::string_view field, const std::string& text) {
    if (field == "proxy")
        return set_proxy(d, text);
    if (field == "surface-map")
        return set_by_name(d.surface_map, 2, field, text);
    if (field == "angular-map")
        return set_by_name(d.angular_map, 4, field, text);
    if (field == "transfer")
        return set_by_name(d.transfer, 2, field, text);
    if (field == "primaries")
        return set_by_name(d.primaries, 1, field, text);
    if (field == "alpha")
        return set_by_name(d.alpha, 2, field, text);
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
