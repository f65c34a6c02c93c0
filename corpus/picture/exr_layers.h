// The layers of an EXR file: which of its channels form the picture that is read.
#pragma once

#include "format/status.h"

#include <ImfMultiPartInputFile.h>
#include <string>
#include <vector>

namespace tessera::corpus {

// How colours are stored.
enum class ExrColours {
    plain,          // as they are: RGB, grey, or any channels of a layer that was asked for
    chroma,         // RY, Y, BY of full resolution
    reduced_chroma, // the same, of which OpenEXR makes RGB
    xyz,            // channels X, Y, Z
};

struct ExrLayer {
    int part = 0;
    std::string prefix; // of the names of its channels, "left." of "left.R"; may be empty
    std::string name;   // for people; empty for channels without a layer
    ExrColours colours = ExrColours::plain;
    std::vector<std::string> channels; // with their prefix, in our order
};

// The layer called `wish` or, if that is empty, the only one with colours; channels without a layer
// come first. A part of several is a layer of its name. Errors, which list the layers: bad_argument
// (none of that name, or no name and several layers); invalid_file (no channels, or a colour is
// missing); unsupported (subsampled).
Result<ExrLayer> choose_layer(const Imf::MultiPartInputFile& file, const std::string& wish);

} // namespace tessera::corpus
