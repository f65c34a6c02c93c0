#include "codec/pass/tile_figures.h"

#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

struct CodedThing {
    TileLevels levels;
    CorrectionMap corrections;
};

CodedThing coded_thing() {
    CodedThing thing;
    TileLevels& levels = thing.levels;
    levels.splits = {1, 0, 0, 2, 0, 0};
    levels.colours = {{}, {.rotation = 3}};
    levels.predictions = {{}, {CopyFrom::along_s, {-1, 2}}};
    levels.planes = {{0, 1, 4}, {1, 2, 8}};
    levels.nonzeros = {{0, 5}, {2, -1}, {7, 1 << 19}};
    thing.corrections = {0, -1, 3};
    return thing;
}

// Each change decodes to different texels, so it must change the sum.
TEST(LevelsSum, DiffersForEveryChange) {
    const std::vector<std::function<void(CodedThing&)>> changes = {
        [](CodedThing&) {},
        [](CodedThing& x) { x.levels.base_blocks = 1; },
        [](CodedThing& x) { x.levels.splits[2] = 1; },
        [](CodedThing& x) { x.levels.colours[1] = {}; },
        [](CodedThing& x) {
            x.levels.colours[0].share = {2, 0};
        },
        [](CodedThing& x) {
            x.levels.colours[0].share = {0, 2};
        },
        [](CodedThing& x) { x.levels.predictions[0].mode = 1; },
        [](CodedThing& x) { x.levels.predictions[1].from = CopyFrom::along_t; },
        [](CodedThing& x) {
            x.levels.predictions[1].displacement = {2, -1};
        },
        [](CodedThing& x) {
            x.levels.predictions[1].displacement = {1, 2};
        },
        [](CodedThing& x) { x.levels.planes[1].coded_length = 10; },
        [](CodedThing& x) { x.levels.planes[0].count = 2; },
        [](CodedThing& x) { x.levels.nonzeros[1].level = 1; },
        [](CodedThing& x) { x.levels.nonzeros[1].index = 3; },
        [](CodedThing& x) { x.levels.nonzeros[2].level = 1; },
        [](CodedThing& x) { x.corrections[1] = 1; },
        [](CodedThing& x) { x.corrections.push_back(0); },
    };
    std::vector<std::uint32_t> sums;
    for (std::size_t i = 0; i < changes.size(); ++i) {
        CodedThing thing = coded_thing();
        changes[i](thing);
        const std::uint32_t sum = sum_of(thing.levels, thing.corrections);
        for (std::size_t j = 0; j < sums.size(); ++j)
            EXPECT_NE(sum, sums[j]) << i << " " << j;
        sums.push_back(sum);
    }
    const CodedThing again = coded_thing();
    EXPECT_EQ(sum_of(again.levels, again.corrections), sums[0]);
}

} // namespace
} // namespace tessera::test
