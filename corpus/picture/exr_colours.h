// The primaries of an EXR picture.
#pragma once

#include <ImfChromaticities.h>
#include <glm/mat3x3.hpp>
#include <string>

namespace tessera::corpus {

// CIE XYZ, whose "primaries" are the axes.
bool are_xyz(const Imf::Chromaticities& colours);
// Those of BT.709 and sRGB, with its white.
bool are_bt709(const Imf::Chromaticities& colours);

// Linear colours to those of BT.709: column vectors. XYZ keeps its white; other primaries with
// another white are adapted (Bradford), so that grey stays grey. The identity where `colours` span
// no triangle.
glm::mat3 to_bt709(const Imf::Chromaticities& colours);

// "red 0.640 0.330, green ..." for people.
std::string words_for(const Imf::Chromaticities& colours);

} // namespace tessera::corpus
