// Facts about an open file in a form that JavaScript can read: an array of numbers and a string.
#pragma once

#include "codec/decoder.h"

#include <string>
#include <vector>

namespace tessera {

// The numbers in the order in which _facts() of tessera.js reads them:
//   size (4 numbers), sample type, channels, proxy, surface map, angular map, transfer, primaries
//   and alpha mode, as FORMAT.md 1.1 numbers them
//   centre (3) and radius of the sphere, distances of the nearest and the farthest observer
//   background (4 samples; 0..1 for unorm8, values for half16), bytes of the file
//   1 if the metadata is packed, else 0
//   alignment of the views along u and v, size of the tile grid (4), number of levels
//   for each level: size (4), largest tile (4), number of tiles along each axis (4), spatial lod,
//   angular lod
std::vector<double> number_facts(const ContainerReader& container);

// The numbers that web_layers() returns.
std::vector<double> layer_facts(const Layers& layers);

// Size of a level in texels. For level 0 it is the size of the texture, not of its tile grid.
Extent4 level_size(const ContainerReader& container, std::size_t level);

// Strings, each terminated by a NUL: the names of proxy, surface map, angular map, transfer,
// primaries, alpha mode and colour transform, as `tessera info` prints them, then the keys and
// values of the metadata. Packed metadata is left out.
std::string text_facts(const ContainerReader& container);

} // namespace tessera
