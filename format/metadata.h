// What a file says about its texels: the description and the key/value pairs. Version numbers are
// defined here, too.
#pragma once

#include "format/status.h"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// Version of the library and the tools.
inline constexpr const char* library_version = "0.1.0";

// The version of FORMAT.md that this library implements. Headers state the oldest minor version
// with the same layout of the container, so that older readers refuse only what they do not know.
inline constexpr std::uint16_t format_version_major = 0;
inline constexpr std::uint16_t format_version_minor = 7;

// Keys (UTF-8, 1..255 bytes, no NUL) and their values (UTF-8, up to 1 MiB, no NUL), sorted by the
// bytes of the keys.
using Metadata = std::map<std::string, std::string>;

// Keys that say how a file was encoded (FORMAT.md 5.5), each with an example of a value. Keys with
// the prefix belong to the encoder.
inline constexpr const char* made_prefix = "tessera:";
inline constexpr const char* software_key = "Software";          // "Tessera 0.1.0"
inline constexpr const char* made_rate_key = "tessera:rate";     // "psnr 40"
inline constexpr const char* made_effort_key = "tessera:effort"; // "3"
inline constexpr const char* made_tools_key = "tessera:tools";   // "-copies"; absent by default

// What the coordinates and the samples mean. The numbers are those of FORMAT.md 1.1.
enum class Proxy : std::uint8_t {
    none = 0,
    sphere = 1,       // seen from outside
    mesh = 2,         // stored in section `prxy`, see format/surface_mesh.h
    sphere_inside = 3 // the sphere seen from inside; its normals point to the centre
};
enum class SurfaceMap : std::uint8_t { none = 0, sphere_longitude_latitude = 1, mesh_uv = 2 };
enum class AngularMap : std::uint8_t {
    none = 0,
    hemisphere_alpha_beta = 1,
    planar_views = 2,
    octahedral_hemisphere = 3,
    octahedral_mirrored = 4
};
enum class Transfer : std::uint8_t { unspecified = 0, srgb = 1, linear = 2 };
enum class Primaries : std::uint8_t { unspecified = 0, bt709 = 1 };
enum class AlphaMode : std::uint8_t { none = 0, straight = 1, premultiplied = 2 };

struct Description {
    Proxy proxy = Proxy::none;
    SurfaceMap surface_map = SurfaceMap::none;
    AngularMap angular_map = AngularMap::none;
    Transfer transfer = Transfer::unspecified;
    Primaries primaries = Primaries::unspecified;
    AlphaMode alpha = AlphaMode::none;
    float sphere_centre[3] = {0, 0, 0}; // world units
    float sphere_radius = 0;            // world units; above 0 for a sphere, 0 for any other proxy
    float viewing_radius[2] = {0, 0};   // nearest and farthest distance of an observer from the
                                        // centre; {0, 0}: anywhere that sees the surface
    bool operator==(const Description&) const = default;
};

constexpr bool is_sphere(Proxy proxy) {
    return proxy == Proxy::sphere || proxy == Proxy::sphere_inside;
}

// The names of an enumeration's values in the order of their numbers, which start at 0. `info`
// prints these names and options accept them. A new value is an enumerator above and a name here.
template <class Enum> inline constexpr std::array<const char*, 0> value_names{};
template <>
inline constexpr std::array<const char*, 4> value_names<Proxy>{"none", "sphere", "mesh",
                                                               "sphere-inside"};
template <>
inline constexpr std::array<const char*, 3> value_names<SurfaceMap>{
    "none", "sphere-longitude-latitude", "mesh-uv"};
template <>
inline constexpr std::array<const char*, 5> value_names<AngularMap>{
    "none", "hemisphere-alpha-beta", "planar-views", "octahedral-hemisphere",
    "octahedral-mirrored"};
template <>
inline constexpr std::array<const char*, 3> value_names<Transfer>{"unspecified", "srgb", "linear"};
template <>
inline constexpr std::array<const char*, 2> value_names<Primaries>{"unspecified", "bt709"};
template <>
inline constexpr std::array<const char*, 3> value_names<AlphaMode>{"none", "straight",
                                                                   "premultiplied"};

template <class Enum>
concept NamedEnum = (value_names<Enum>.size() > 0);

// Whether FORMAT.md defines the value. A file may hold others of these enumerations.
template <NamedEnum Enum> constexpr bool is_known(Enum value) {
    return static_cast<std::size_t>(value) < value_names<Enum>.size();
}

// "unknown" for a value that is not known.
template <NamedEnum Enum> constexpr const char* name_of(Enum value) {
    return is_known(value) ? value_names<Enum>[static_cast<std::size_t>(value)] : "unknown";
}

// The index of the name that equals `text`, none if there is none. Only letters and digits are
// compared, without case: "BT.709" is "bt709" and "mesh uv" is "mesh-uv".
std::optional<std::size_t> find_name(std::span<const char* const> names, std::string_view text);

// The value with the name `text`, compared as find_name() does; none if there is none.
template <NamedEnum Enum> std::optional<Enum> parse_value(std::string_view text) {
    const std::optional<std::size_t> index = find_name(value_names<Enum>, text);
    return index ? std::optional(static_cast<Enum>(*index)) : std::nullopt;
}

} // namespace tessera
