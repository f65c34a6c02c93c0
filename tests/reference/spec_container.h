// Header, sections, metadata and geometry of a file (FORMAT.md 1.1 to 1.4).
#pragma once

#include "tests/reference/spec_notation.h"

#include <array>
#include <map>
#include <string>

namespace tessera_reference::spec {

struct Header {
    uint64_t required_features = 0;
    uint64_t file_size = 0;
    uint32_t index_size = 0;
    uint32_t section_count = 0;
    uint32_t page_target = 0;
    std::array<uint32_t, 4> size{};
    std::array<int, 2> alignment{};
    std::array<uint32_t, 4> grid{};        // size of level 0's grid in texels (part 2)
    std::array<uint32_t, 4> tile_extent{}; // sides in texels; the file stores them minus 1
    int sample_type = 0;
    int channels = 0;
    int colour = 0;
    int proxy = 0;
    uint32_t level_count = 0;
    std::array<uint16_t, 4> background{};
    uint64_t identity = 0;

    size_t texel_bytes() const { return static_cast<size_t>(channels) * (sample_type ? 2 : 1); }
    bool has_levels() const { return required_features & 1; }
    bool has_corrections() const { return required_features >> 1 & 1; }
    bool has_predictions() const { return required_features >> 4 & 1; }
    bool is_aligned() const { return required_features >> 6 & 1; }
    bool has_stored_tiles() const { return required_features >> 5 & 1; }
    bool leaves_out_transforms() const { return required_features >> 8 & 1; }
    bool transforms_any_plane() const { return required_features >> 9 & 1; }
    bool has_plane_trees() const { return required_features >> 10 & 1; }
    bool has_layers() const { return required_features >> 7 & 1; }
};

Header read_header(Bytes file);

struct Section {
    uint64_t offset = 0;
    Bytes bytes;
};

// All sections, also INDX and DATA.
std::map<std::string, Section> read_sections(Bytes file, const Header& header);

// Checks section geom, which does not affect the texels.
void check_geometry(const std::map<std::string, Section>& sections, const Header& header);

std::map<std::string, std::string> read_metadata(Bytes section);

} // namespace tessera_reference::spec
