// The one place that knows version numbers.
#pragma once

#include <cstdint>

namespace tessera {

// Version of the library and the tools.
inline constexpr const char* library_version = "0.1.0";

// Version of FORMAT.md that is written, and the only one that is read.
inline constexpr std::uint16_t format_version_major = 0;
inline constexpr std::uint16_t format_version_minor = 2;

} // namespace tessera
