#include "codec/pass/levels_sum.h"

namespace tessera {
namespace {

// A bijection of the state for every value: one value that differs changes the sum for certain, as long
// as it is not cut to 32 bits, and then all but once in 2^32. The multiplier is that of SplitMix64.
class Sum {
public:
    void add(std::uint64_t value) {
        state_ = (state_ ^ value) * 0xBF58476D1CE4E5B9u;
        state_ ^= state_ >> 29;
    }
    std::uint32_t value() const { return static_cast<std::uint32_t>(state_ >> 32); }

private:
    std::uint64_t state_ = 0x9E3779B97F4A7C15u;
};

std::uint64_t unsigned_of(std::int32_t value) {
    return static_cast<std::uint32_t>(value);
}

} // namespace

std::uint32_t sum_of(const TileLevels& levels, const CorrectionMap& corrections) {
    Sum sum;
    sum.add(levels.base_blocks);
    for (const std::uint8_t split : levels.splits) // blocks follow from them
        sum.add(split);
    for (const std::uint8_t colour : levels.colours)
        sum.add(colour);
    for (const BlockPrediction& prediction : levels.predictions)
        sum.add(static_cast<std::uint64_t>(prediction.from) << 32 |
                (unsigned_of(prediction.displacement.u) & 0xFF) << 8 |
                (unsigned_of(prediction.displacement.v) & 0xFF));
    for (const PlaneLevels& plane : levels.planes)
        sum.add(std::uint64_t{plane.coded_length} << 32 | plane.count);
    for (const NonZero& nz : levels.nonzeros)
        sum.add(std::uint64_t{nz.index} << 32 | unsigned_of(nz.level));
    for (const std::int32_t multiplier : corrections)
        sum.add(unsigned_of(multiplier));
    return sum.value();
}

} // namespace tessera
