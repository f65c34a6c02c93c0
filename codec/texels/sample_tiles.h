// Chooses a sample of boxes where processing all of them would take too long.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// `wanted` of the numbers 0..count-1 (all if there are fewer), ascending. Every choice is equally
// likely. The same seed gives the same choice on every machine.
std::vector<std::uint64_t> choose_numbers(std::uint64_t count, std::uint64_t wanted,
                                          std::uint64_t seed);

// The indices of the `wanted` (or all) largest values, largest first; equal values keep their
// order.
std::vector<std::size_t> largest_values(std::span<const std::uint64_t> values, std::size_t wanted);

} // namespace tessera
