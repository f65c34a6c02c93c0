#include "codec/texels/sample_tiles.h"

#include <algorithm>
#include <numeric>
#include <unordered_set>

namespace tessera {

namespace {

// SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t next_random(std::uint64_t& state) {
    std::uint64_t z = state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

// A uniform number below `limit`: values that would favour small numbers are rejected.
std::uint64_t below(std::uint64_t limit, std::uint64_t& state) {
    const std::uint64_t unfair = (0 - limit) % limit; // 2^64 mod limit
    std::uint64_t value = next_random(state);
    while (value < unfair)
        value = next_random(state);
    return value % limit;
}

} // namespace

// Robert Floyd's sampling (Bentley, "Programming Pearls: a sample of brilliance", 1987).
std::vector<std::uint64_t> choose_numbers(std::uint64_t count, std::uint64_t wanted,
                                          std::uint64_t seed) {
    wanted = std::min(count, wanted);
    std::unordered_set<std::uint64_t> chosen;
    for (std::uint64_t i = count - wanted; i < count; ++i)
        if (const std::uint64_t pick = below(i + 1, seed); !chosen.insert(pick).second)
            chosen.insert(i);
    std::vector<std::uint64_t> numbers(chosen.begin(), chosen.end());
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

std::vector<std::size_t> largest_values(std::span<const std::uint64_t> values, std::size_t wanted) {
    std::vector<std::size_t> places(values.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::ranges::stable_sort(places, [&](auto a, auto b) { return values[a] > values[b]; });
    places.resize(std::min(places.size(), wanted));
    return places;
}

} // namespace tessera
