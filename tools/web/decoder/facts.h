// What an open file is, as JavaScript takes it: numbers in a fixed order and texts.
#pragma once

#include "codec/decoder.h"

#include <string>
#include <vector>

namespace tessera {

// In the order that facts() of tessera.js reads: size, type, channels, proxy, angular map, transfer,
// primaries, alpha mode, sphere's centre and radius, nearest and farthest observer, background's four
// samples (0..1, or the half's value), bytes of the file, whether metadata is packed (0 or 1), the
// alignment of views along u and v, size of the grid, number of levels, then of each: size, largest tile,
// number of tiles along each axis, spatial and angular lod.
std::vector<double> number_facts(const ContainerReader& container);

// Texels of a level; of level 0 those of the texture, not of its grid.
Extent4 level_size(const ContainerReader& container, std::size_t level);

// Texts, each ended by a NUL: names of proxy and angular map, colour transform, then keys and values of
// the metadata, if it can be read.
std::string text_facts(const ContainerReader& container);

} // namespace tessera
