// A spread of boxes to look at where looking at all of them is too dear.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// `wanted` of the numbers 0..count-1 (all of them if there are no more), ascending; every choice is
// equally likely, and the same seed gives the same one on any machine.
std::vector<std::uint64_t> choose_numbers(std::uint64_t count, std::uint64_t wanted,
                                          std::uint64_t seed);

// The places of the `wanted` largest values (of all, if there are no more), the largest first, equal
// ones as they stand.
std::vector<std::size_t> largest_values(std::span<const std::uint64_t> values, std::size_t wanted);

} // namespace tessera
