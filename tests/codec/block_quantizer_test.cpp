// The cost that the quantiser reports, and how close its levels come to the optimum.
#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "codec/reconstruct/tile_decoder.h"
#include "codec/tile_encoder/bit_costs.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

// Adds up the ideal cost, in bits, of the symbols of a walk.
struct BitCounter {
    const BitCosts& costs;
    double bits = 0;

    void split(int, int, int) {}
    void first_length(int size, int token) {
        bits += costs.first_length[static_cast<std::size_t>(size)][static_cast<std::size_t>(token)];
    }
    void other_length(int previous, int token) {
        bits +=
            costs.other_length[static_cast<std::size_t>(previous)][static_cast<std::size_t>(token)];
    }
    void colour(int, int) {}
    void share(int, int) {}
    void mode(int, int) {}
    void transform(int, int) {}
    void zero(int parameter, bool is_zero) {
        bits += costs.zero[static_cast<std::size_t>(parameter)][is_zero ? 0 : 1];
    }
    void magnitude(int table, int token) {
        bits += costs.magnitude[static_cast<std::size_t>(table)][static_cast<std::size_t>(token)];
    }
    void raw(std::uint32_t, int) {} // counted in the cost of their symbol
};

// One block and one way to quantise it.
class QuantizerTrial {
public:
    QuantizerTrial(const BlockShape& shape, int planes, bool dependent,
                   const ReconstructionOffsets& offsets = {})
        : coding_(parameters(dependent, offsets), SampleType::unorm8, planes),
          costs_(coding_.tables) {
        block_.shape = shape;
        for (auto& plane : block_.plane)
            plane.resize(static_cast<std::size_t>(shape.texels()));
    }

    // Fills the block with Laplacian coefficients in sample units. They fall with the frequency.
    void fill(Random& random, double gain) {
        const ScanOrder& order = coding_.shape(block_.shape).order;
        const auto& n = block_.shape.n;
        for (int plane = 0; plane < coding_.planes; ++plane)
            for (int i = 0; i < order.length(); ++i) {
                const auto& k = order.entry[static_cast<std::size_t>(i)].k;
                const double x = gain * std::log(1 - random.unit()) / (1 + 0.2 * i);
                block_.plane[static_cast<std::size_t>(plane)][static_cast<std::size_t>(
                    ((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] =
                    static_cast<float>(random.chance(0.5) ? x : -x);
            }
    }

    // Quantises the block and returns the cost that the quantiser reports.
    double run() {
        tile_.clear();
        tile_.shape = block_.shape;
        tile_.splits = {0};
        tile_.blocks = {Block{{0, 0, 0, 0}, block_.shape, 0, 0}};
        return BlockQuantizer(coding_, costs_, {}).quantize(block_, tile_).all;
    }
    // The squared error less that of zero levels, plus lambda times the bits of the tile's levels.
    double cost_of(const TileLevels& tile) const {
        BitCounter counter{costs_};
        TileWalker(coding_, counter).walk_block(tile, 0);
        double cost = QuantizerOptions{}.lambda * counter.bits;
        const ScanOrder& order = coding_.shape(block_.shape).order;
        const auto& n = block_.shape.n;
        for (int plane = 0; plane < coding_.planes; ++plane)
            for (const NonZero& nz : tile.levels(tile.planes[static_cast<std::size_t>(plane)])) {
                const auto& k = order.entry[nz.index].k;
                const double x =
                    block_.plane[static_cast<std::size_t>(plane)][static_cast<std::size_t>(
                        ((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] /
                    8;
                const double offset =
                    coding_.parameters.offsets[0][std::abs(nz.level) > 1 ? 1 : 0] / 64.0;
                const double value = std::copysign(std::abs(nz.level) - offset, nz.level) *
                                     (coding_.parameters.dependent ? 0.5 : 1.0);
                cost += (x - value) * (x - value) - x * x;
            }
        return cost;
    }
    const TileLevels& tile() const { return tile_; }
    TileLevels no_levels() const {
        TileLevels none = tile_;
        none.nonzeros.clear();
        for (PlaneLevels& plane : none.planes)
            plane = {};
        return none;
    }
    // Greedy dependent levels for the first plane, up to the coded length that the quantiser chose.
    TileLevels nearest_levels() const {
        TileLevels tile = no_levels();
        const ScanOrder& order = coding_.shape(block_.shape).order;
        const auto& n = block_.shape.n;
        int state = 0;
        for (int i = 0; i < tile_.planes[0].coded_length; ++i) {
            const auto& k = order.entry[static_cast<std::size_t>(i)].k;
            const double x = block_.plane[0][static_cast<std::size_t>(
                                 ((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] /
                             4; // half steps
            const int quantiser = quantiser_of(state);
            const int magnitude =
                static_cast<int>(std::max(0.0, (std::fabs(x) + quantiser) / 2 + 0.4));
            if (magnitude > 0) {
                const int level = 2 * magnitude - quantiser;
                tile.nonzeros.push_back({static_cast<std::uint16_t>(i), x < 0 ? -level : level});
            }
            state = next_state[static_cast<std::size_t>(state)]
                              [static_cast<std::size_t>(magnitude & 1)];
        }
        tile.planes[0].count = static_cast<std::uint16_t>(tile.nonzeros.size());
        if (!tile.nonzeros.empty())
            tile.planes[0].coded_length = static_cast<std::uint16_t>(
                round_up_coded_length(tile.nonzeros.back().index + 1, order.length()));
        return tile;
    }

private:
    static CodingParameters parameters(bool dependent, const ReconstructionOffsets& offsets) {
        CodingParameters p;
        p.step.fill(StepCode::nearest(8));
        p.rotated_step = p.step[0];
        p.dependent = dependent;
        p.offsets.fill(offsets);
        return p;
    }
    const TileCoding coding_;
    const BitCosts costs_;
    BlockCoefficients block_;
    TileLevels tile_;
};

TEST(BlockQuantizer, ReportsTheCostOfItsLevels) {
    for (const bool dependent : {false, true}) {
        Random random(31);
        double reported = 0, real = 0;
        for (int round = 0; round < 60; ++round) {
            const bool moved = round % 2 == 0; // the encoder itself uses no offsets
            QuantizerTrial trial(shape_of(8, 6, 4, 3), 1 + round % 4, dependent,
                                 moved ? ReconstructionOffsets{2, 30} : ReconstructionOffsets{});
            trial.fill(random, 4 << (round % 6));
            const double now = trial.run();
            const double cost = trial.cost_of(trial.tile());
            reported += now;
            real += cost;
            // The costs differ a little: paths that merge outside the window share contexts, and a
            // coded length may include trailing levels that become zero.
            ASSERT_NEAR(now, cost, (dependent ? 0.01 : 1e-3) * std::fabs(cost) + 0.5) << round;
        }
        EXPECT_NEAR(reported, real, 2e-3 * std::fabs(real));
    }
}

// Planning ahead costs less than choosing the nearest allowed level of each coefficient in turn,
// and less than coding no levels.
TEST(BlockQuantizer, LookingAheadPays) {
    Random random(32);
    double ahead = 0, nearest = 0;
    for (int round = 0; round < 60; ++round) {
        const BlockShape shape = round % 2 == 0 ? shape_of(8, 8, 4, 4) : shape_of(16, 4, 3, 5);
        QuantizerTrial trial(shape, 1, true);
        trial.fill(random, 8 << (round % 5));
        trial.run();
        const double cost = trial.cost_of(trial.tile());
        const double greedy = trial.cost_of(trial.nearest_levels());
        ASSERT_LE(cost, greedy + 0.3) << round; // the effect on later contexts is ignored
        ASSERT_LE(cost, trial.cost_of(trial.no_levels()) + 1e-3) << round;
        ahead += cost;
        nearest += greedy;
    }
    EXPECT_LT(ahead, nearest - 60 * 0.5);
}

// Compares the chosen levels with every possible sequence of levels.
TEST(BlockQuantizer, IsNearTheBestSequenceOfSmallBlocks) {
    Random random(33);
    for (const bool dependent : {false, true})
        for (int round = 0; round < 40; ++round) {
            QuantizerTrial trial(shape_of(2, 2, 1, 1), 1, dependent);
            trial.fill(random, 24);
            trial.run();
            const double chosen = trial.cost_of(trial.tile());
            double best = 1e30;
            constexpr int most = 4; // magnitude
            const int signs = 2 * most + 1;
            for (int code = 0; code < signs * signs * signs * signs; ++code) {
                TileLevels tile = trial.tile();
                tile.nonzeros.clear();
                int state = 0, rest = code;
                for (int i = 0; i < 4; ++i, rest /= signs) {
                    const int x = rest % signs - most, magnitude = std::abs(x);
                    const int level = dependent ? 2 * magnitude - quantiser_of(state) : magnitude;
                    if (x != 0)
                        tile.nonzeros.push_back(
                            {static_cast<std::uint16_t>(i), x < 0 ? -level : level});
                    if (dependent)
                        state = next_state[static_cast<std::size_t>(state)]
                                          [static_cast<std::size_t>(magnitude & 1)];
                }
                tile.planes[0].count = static_cast<std::uint16_t>(tile.nonzeros.size());
                tile.planes[0].coded_length = static_cast<std::uint16_t>(
                    tile.nonzeros.empty() ? 0 : tile.nonzeros.back().index + 1);
                best = std::min(best, trial.cost_of(tile));
            }
            // The quantiser ignores how a level changes later contexts, and it sets coefficients
            // below 0.55 steps to zero.
            EXPECT_LE(chosen, best + 0.5) << round;
        }
}

} // namespace
} // namespace tessera::test
