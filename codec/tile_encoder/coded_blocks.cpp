#include "codec/tile_encoder/coded_blocks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <functional>
#include <string_view>

namespace tessera {
namespace {

// Limits of some MB, beyond which everything is forgotten.
constexpr std::size_t most_kept_levels = std::size_t{1} << 19;
constexpr std::size_t most_kept_blocks = std::size_t{1} << 16;

// Two different blocks share a fingerprint once in 2^64 cases. One then takes the other's levels,
// which cost more but are valid. Four states, because each waits for its product.
std::uint64_t fingerprint_of(const BlockCoefficients& block, int planes) {
    // A bijection of the state for every value, with SplitMix64's multiplier.
    const auto add = [](std::uint64_t& state, std::uint64_t value) {
        state = std::rotl((state ^ value) * 0xBF58476D1CE4E5B9u, 31);
    };
    std::array<std::uint64_t, 4> states{1, 2, 3, 4};
    constexpr std::size_t at_once = sizeof states;
    const auto add_bytes = [&](const std::byte* from, std::size_t count) {
        std::array<std::uint64_t, states.size()> values{};
        std::memcpy(values.data(), from, count);
        for (std::size_t lane = 0; lane < states.size(); ++lane)
            add(states[lane], values[lane]);
    };
    const std::size_t bytes = block.shape.texels() * sizeof(float);
    for (int p = 0; p < planes; ++p) {
        const auto* from = reinterpret_cast<const std::byte*>(block.plane[p].data());
        std::size_t i = 0;
        for (; i + at_once <= bytes; i += at_once)
            add_bytes(from + i, at_once);
        add_bytes(from + i, bytes - i);
    }
    std::uint64_t all = 0;
    for (const std::uint64_t state : states)
        add(all, state);
    return all;
}

} // namespace

std::size_t CodedBlocks::Hash::operator()(const Key& key) const {
    return std::hash<std::string_view>{}({reinterpret_cast<const char*>(key.data()), key.size()});
}

void CodedBlocks::begin(bool keep) {
    keep_ = keep;
    known_.clear();
    levels_.clear();
}

CodedBlock& CodedBlocks::at(const Block& block, const BlockPrediction& prediction) {
    if (!keep_) {
        levels_.clear();
        last_.ways.clear();
        last_.moments.reset();
        return last_;
    }
    if (levels_.nonzeros.size() > most_kept_levels || known_.size() > most_kept_blocks)
        begin(keep_);
    const auto& o = block.origin;
    const auto& n = block.shape.n;
    const auto side = [&n](std::size_t axis) { return static_cast<std::uint8_t>(n[axis]); };
    return known_[{o[0], o[1], o[2], o[3], side(0), side(1), side(2), side(3),
                   static_cast<std::uint8_t>(prediction.from),
                   static_cast<std::uint8_t>(prediction.displacement.u),
                   static_cast<std::uint8_t>(prediction.displacement.v)}];
}

void CodedBlocks::check(CodedBlock& coded, const BlockCoefficients& coefficients, int planes) {
    if (!keep_ || !coefficients.copies)
        return;
    const std::uint64_t fingerprint = fingerprint_of(coefficients, planes);
    if (coded.fingerprint == fingerprint)
        return;
    coded.fingerprint = fingerprint;
    coded.ways.clear();
    coded.moments.reset();
}

bool CodedBlocks::is_zero(const CodedBlock::Way& way, int planes) const {
    return std::all_of(&levels_.planes[way.planes], &levels_.planes[way.planes] + planes,
                       [](const PlaneLevels& plane) { return plane.count == 0; });
}

void CodedBlocks::append(const CodedBlock::Way& way, int planes, TileLevels& out) const {
    out.colours.push_back(way.colour);
    for (int p = 0; p < planes; ++p) {
        PlaneLevels plane = levels_.planes[way.planes + p];
        const auto levels = levels_.levels(plane);
        plane.first = static_cast<std::uint32_t>(out.nonzeros.size());
        out.planes.push_back(plane);
        out.nonzeros.insert(out.nonzeros.end(), levels.begin(), levels.end());
    }
}

} // namespace tessera
