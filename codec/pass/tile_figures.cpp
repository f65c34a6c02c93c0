#include "codec/pass/tile_figures.h"

#include "codec/search_kernels/search_kernels.h"
#include "format/samples.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {
namespace {

// Every step is a bijection of the state, so the 64-bit state differs for certain when one value
// differs; its upper half differs in all but one of 2^32 cases. The multiplier is SplitMix64's.
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

void measure_error(std::span<const std::byte> a, std::span<const std::byte> b, SampleType type,
                   CodedTile& tile) {
    if (sample_bytes(type) == 1) {
        const ByteErrors errors = search_kernels().compare_bytes(
            reinterpret_cast<const unsigned char*>(a.data()),
            reinterpret_cast<const unsigned char*>(b.data()), a.size());
        tile.squared_error = errors.squared;
        tile.max_error = errors.largest;
        return;
    }
    tile.squared_error = 0;
    tile.max_error = 0;
    for (std::size_t i = 0; i < a.size(); i += sample_bytes(type)) {
        const auto code = [&](std::span<const std::byte> texels) {
            return sample_code(load_sample(texels.data() + i, type), type);
        };
        const auto error = static_cast<std::uint32_t>(std::abs(code(a) - code(b)));
        tile.squared_error += std::uint64_t{error} * error;
        tile.max_error = std::max(tile.max_error, error);
    }
}

double lagrangian_cost(const EncodePlan& plan, const CodingParameters& parameters,
                       const CodedTile& tile) {
    // The steps of YCoCg are chosen so that an error of one step counts three times over RGB.
    const double samples = plan.colour.transform == ColourTransform::ycocg_r ? 3 : 1;
    const double step = parameters.step[0].value();
    return static_cast<double>(tile.squared_error) / (samples * step * step) +
           8.0 * static_cast<double>(plan.effort.quantizer.lambda) * tile.payload_bytes;
}

std::uint32_t sum_of(const TileLevels& levels, const CorrectionMap& corrections) {
    Sum sum;
    sum.add(levels.base_blocks);
    sum.add(levels.second_tree);
    for (const std::uint8_t split : levels.splits) // the blocks follow from the splits
        sum.add(split);
    for (const BlockColour& colour : levels.colours)
        sum.add(std::uint64_t{colour.rotation} << 16 | (unsigned_of(colour.share[0]) & 0xFF) << 8 |
                (unsigned_of(colour.share[1]) & 0xFF));
    for (const BlockPrediction& prediction : levels.predictions)
        sum.add(static_cast<std::uint64_t>(prediction.from) << 32 |
                static_cast<std::uint64_t>(prediction.transform) << 24 |
                static_cast<std::uint64_t>(prediction.mode) << 16 |
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
