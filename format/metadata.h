// What a file says about its texels besides the texels: key/values and the description; and the one
// place that knows version numbers.
#pragma once

#include "format/status.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// Version of the library and the tools.
inline constexpr const char* library_version = "0.1.0";

// Version of FORMAT.md that is written, and the only one that is read.
inline constexpr std::uint16_t format_version_major = 0;
inline constexpr std::uint16_t format_version_minor = 3;

// UTF-8 keys (1..255 bytes, no NUL) to UTF-8 values (up to 1 MiB), sorted by key bytes.
using Metadata = std::map<std::string, std::string>;

// Keys that say how a file was encoded, FORMAT.md 5.5; the encoder writes all with this prefix.
inline constexpr const char* made_prefix = "tessera:";
inline constexpr const char* software_key = "Software";          // "Tessera 0.1.0"
inline constexpr const char* made_rate_key = "tessera:rate";     // "psnr 40"
inline constexpr const char* made_effort_key = "tessera:effort"; // "3"
inline constexpr const char* made_tools_key = "tessera:tools";   // "-copies"; only where switched

// Meaning of the coordinates and the samples. Numbers are those of FORMAT.md.
enum class Proxy : std::uint8_t {
    none = 0,
    sphere = 1,       // seen from outside
    mesh = 2,         // in section `prxy`, format/surface_mesh.h
    sphere_inside = 3 // the sphere seen from inside: its normals point to the centre
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
    float sphere_radius = 0;            // world units, above 0 when proxy is a sphere
    float viewing_radius[2] = {0, 0};   // viewing volume: nearest and farthest observer distance
                                        // from the centre; {0, 0} is "anywhere that sees it"
    bool operator==(const Description&) const = default;
};

// Either of the two.
constexpr bool is_sphere(Proxy proxy) {
    return proxy == Proxy::sphere || proxy == Proxy::sphere_inside;
}

const char* name_of(Proxy);
const char* name_of(SurfaceMap);
const char* name_of(AngularMap);
const char* name_of(Transfer);
const char* name_of(Primaries);
const char* name_of(AlphaMode);

} // namespace tessera
