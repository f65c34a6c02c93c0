// Opens a .tess file and finds its tiles. Checks everything before it is used.
#pragma once

#include "format/byte_source.h"
#include "format/metadata.h"
#include "format/status.h"
#include "format/syntax.h"
#include "format/texture.h"

#include <memory>
#include <span>
#include <vector>

namespace tessera {

// Where a tile's bytes are. length 0: every texel of the tile is the file's background.
struct TileLocation {
    std::uint64_t offset = 0;
    std::uint32_t length = 0;
};

// One numbered finding of validate().
struct Finding {
    int number = 0; // stable id of the rule, listed in FORMAT.md
    bool fatal = true;
    std::string text;
};

struct SectionInfo {
    std::string type; // four characters
    std::uint64_t offset = 0, length = 0;
    bool required = false, known = false;
};

} // namespace tessera
