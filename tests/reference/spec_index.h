// Levels, tiles, groups and pages (FORMAT.md 1.5).
#pragma once

#include "tests/reference/spec_container.h"

#include <array>
#include <map>
#include <string>
#include <vector>

namespace tessera_reference::spec {

struct Level {
    std::array<uint32_t, 4> size{};
    std::array<uint64_t, 4> n{}; // tiles along the axes (part 2)
    uint64_t first_tile = 0, tiles = 1;
    int step_shift = 0;
};

std::vector<Level> read_levels(const std::map<std::string, Section>& sections,
                               const Header& header);

// Returns the payload of every tile by its number and verifies all checksums.
std::vector<Bytes> read_tiles(Bytes file, const Header& header,
                              const std::map<std::string, Section>& sections,
                              const std::vector<Level>& levels);

} // namespace tessera_reference::spec
