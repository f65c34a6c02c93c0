// Section LAYR (FORMAT.md 1.7).
#pragma once

#include "format/layers.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

inline constexpr std::size_t most_layers = 32; // with the first
inline constexpr std::size_t most_lights = 1024;

// `first_beginning` is where section INDX of the file ends. Errors: invalid_file, without the
// file's name.
Result<Layers> read_layers(std::span<const std::byte> section, std::uint64_t first_beginning,
                           std::uint64_t file_size);
// The inverse. Offsets are not stored.
std::vector<std::byte> write_layers(const Layers& layers);

} // namespace tessera
