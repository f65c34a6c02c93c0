// Colour profiles (ICC), of which only sRGB is known.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace tessera::corpus {

// "" where the profile is sRGB, or grey with its curve or nearly so; else a note for people that
// names the profile. `otherwise`: its name where the profile has none.
std::string icc_note(std::span<const std::byte> profile, const std::string& otherwise = "");

} // namespace tessera::corpus
