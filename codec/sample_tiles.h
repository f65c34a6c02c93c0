// A spread of boxes to look at where looking at all of them is too dear.
#pragma once

#include <cstdint>
#include <vector>

namespace tessera {

// `wanted` of the numbers 0..count-1 (all of them if there are no more), ascending; every choice is
// equally likely, and the same seed gives the same one on any machine.
std::vector<std::uint64_t> choose_numbers(std::uint64_t count, std::uint64_t wanted,
                                          std::uint64_t seed);

} // namespace tessera
