// Compares the library with the second decoder on encoded files. The second decoder is written from
// FORMAT.md alone.
#include "corpus/bake.h"
#include "tests/reference/agreement.h"
#include "tests/support/efforts.h"
#include "tests/support/moving_views.h"

#include <iterator>

namespace tessera {
namespace {

using namespace test;

const RateTarget rates[] = {{Kind::quality, 20},  {Kind::quality, 60},  {Kind::quality, 95},
                            {Kind::max_error, 0}, {Kind::max_error, 1}, {Kind::max_error, 3}};
const Extent4 extents[] = {{8, 8, 4, 4}, {32, 32, 8, 8}, {5, 7, 3, 2}, {16, 16, 16, 16}};

std::string describe(const RateTarget& rate, const Extent4& extent) {
    return std::string(rate.kind == Kind::quality ? ", quality " : ", max error ") +
           std::to_string(static_cast<int>(rate.value)) + ", tiles " + to_string(extent);
}

void check_all_rates(TexelSource& source, const std::string& what, bool all_extents) {
    for (std::size_t r = 0; r < std::size(rates); ++r)
        for (std::size_t e = 0; e < std::size(extents); ++e)
            if (all_extents || e == r % std::size(extents))
                expect_decodes(encode(source, rates[r], extents[e]),
                               what + describe(rates[r], extents[e]));
}

TEST(Reference, SmallTexturesOfEveryKind) {
    for (const Extent4& size : {Extent4{1, 1, 1, 1}, Extent4{7, 5, 3, 2}, Extent4{1, 9, 1, 17}})
        for (const SampleType type : {SampleType::unorm8, SampleType::half16})
            for (int channels = 1; channels <= 4; ++channels)
                for (const char* name : {"black", "constant", "waves", "noise", "signed"}) {
                    CodeTexture texture = make_texture(name, size, channels, type);
                    check_all_rates(texture,
                                    std::string(name) + " " + to_string(size) + " x" +
                                        std::to_string(channels),
                                    size[0] == 7);
                }
}

TEST(Reference, OddAndLargerTextures) {
    int turn = 0;
    for (const Extent4& size : {Extent4{33, 9, 9, 13}, Extent4{40, 20, 9, 8}})
        for (const SampleType type : {SampleType::unorm8, SampleType::half16})
            for (const char* name : {"sparse", "waves", "coloured"}) {
                const int channels = 1 + turn % 4;
                CodeTexture texture = make_texture(name, size, channels, type);
                for (std::size_t i = 0; i < 2; ++i) {
                    const auto k = static_cast<std::size_t>(turn);
                    const RateTarget& rate = rates[(k + 3 * i) % std::size(rates)];
                    const Extent4& extent = extents[(k + i) % std::size(extents)];
                    expect_decodes(encode(texture, rate, extent),
                                   std::string(name) + " " + to_string(size) + " x" +
                                       std::to_string(channels) + describe(rate, extent));
                }
                ++turn;
            }
}

TEST(Reference, ScenesOfTheCorpus) {
    std::size_t turn = 0;
    for (const char* scene : {"composed", "lamps", "gallery", "hard"}) {
        const Extent4 size = turn % 2 ? Extent4{40, 20, 9, 8} : Extent4{33, 9, 9, 13};
        auto source = corpus::make_baked_source(scene, size, 2, 1);
        ASSERT_TRUE(source) << source.status().message();
        for (std::size_t i = 0; i < std::size(rates); i += 2) {
            const RateTarget& rate = rates[(turn + i) % std::size(rates)];
            const Extent4& extent = extents[(turn + i / 2) % std::size(extents)];
            expect_decodes(encode(**source, rate, extent), scene + describe(rate, extent));
        }
        ++turn;
    }
    auto rgb = corpus::make_baked_source("composed", {20, 9, 8, 8}, 2, 1);
    ASSERT_TRUE(rgb) << rgb.status().message();
    WithAlpha rgba(**rgb);
    for (const RateTarget& rate : rates)
        expect_decodes(encode(rgba, rate, extents[1]), "RGBA" + describe(rate, extents[1]));
}

// Views move by two texels along u and by two or minus two along v. The grid of tiles undoes this.
TEST(Reference, AlignedViews) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const RateTarget& rate :
             {RateTarget{Kind::quality, 60}, RateTarget{Kind::max_error, 0}})
            for (const int v : {2, -2}) {
                if (type == SampleType::half16 && rate.kind == Kind::max_error)
                    continue; // such tiles are stored
                test::MemoryTexture texture = test::moving_views({{41, 40, 3, 4}, type, 1}, 2, v);
                const Bytes file = encode(texture, rate, {16, 12, 3, 4}, {}, test::copies_effort);
                EXPECT_EQ(file[16] & std::byte{64}, std::byte{64}); // feature 6
                EXPECT_EQ(file[70], std::byte{0xFE});
                EXPECT_EQ(file[71], static_cast<std::byte>(-v));
                expect_decodes(file, "moving by " + std::to_string(v));
            }
}

// Blocks with more than 32 texels along an axis code only 32 frequencies of it.
TEST(Reference, TilesOfUpTo64Texels) {
    for (const char* name : {"waves", "coloured", "noise"})
        for (const auto& [size, extent] : {std::pair{Extent4{70, 66, 5, 3}, Extent4{64, 64, 4, 4}},
                                           {{63, 45, 3, 2}, {63, 45, 3, 2}},
                                           {{64, 1, 6, 6}, {64, 1, 6, 6}},
                                           {{3, 130, 4, 1}, {8, 64, 4, 1}}})
            for (const RateTarget& rate : {RateTarget{Kind::quality, 50}, {Kind::quality, 95}}) {
                CodeTexture texture = make_texture(name, size, 3, SampleType::unorm8);
                expect_decodes(encode(texture, rate, extent),
                               name + (" " + to_string(size)) + describe(rate, extent));
            }
    auto source = corpus::make_baked_source("composed", {80, 64, 6, 4}, 2, 1);
    ASSERT_TRUE(source) << source.status().message();
    expect_decodes(encode(**source, {Kind::quality, 55}, {64, 64, 4, 4}), "composed, wide tiles");
}

// Tiles of more than 65,536 texels. Golden files and predicted_cases() cover base pictures in them.
TEST(Reference, LargeTiles) {
    test::MemoryTexture views = test::moving_views({{64, 64, 5, 4}, SampleType::unorm8, 3}, 1, -1);
    expect_decodes(encode(views, {Kind::quality, 50}, {64, 64, 5, 4}, {}, copies_effort), "views");
    CodeTexture noise = make_texture("noise", {48, 30, 8, 8}, 3, SampleType::unorm8);
    expect_decodes(encode(noise, {Kind::quality, 100}, {48, 30, 8, 8}), "noise");
}

// At the finest quality noise fills several segments per tile and several pages.
TEST(Reference, TilesOfManySegments) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const int channels : {3, 4})
            for (const char* name : {"noise", "coloured"}) {
                CodeTexture texture = make_texture(name, {17, 9, 16, 16}, channels, type);
                expect_decodes(encode(texture, {Kind::quality, 100}, {16, 16, 16, 16}), name);
            }
    CodeTexture texture = make_texture("noise", {16, 8, 16, 16}, 3, SampleType::unorm8);
    expect_decodes(encode(texture, {Kind::max_error, 0}, {16, 16, 16, 16}), "lossless noise");
}

TEST(Reference, Metadata) {
    CodeTexture texture = make_texture("waves", {3, 2, 2, 2}, 1);
    for (const Metadata& metadata :
         {Metadata{}, Metadata{{"Author", "J\xC3\xA4ger"}, {"empty", ""}},
          Metadata{{"long", std::string(100000, 'x')}, {"\xC3\xA4", "2"}, {"z", "1"}}}) {
        const Bytes file = encode(texture, {Kind::quality, 60}, {8, 8, 4, 4}, metadata);
        const Outcome outcome = expect_agreement(file, "metadata");
        ASSERT_TRUE(outcome.accepted) << outcome.error;
        for (const auto& [key, value] : metadata)
            EXPECT_EQ(outcome.metadata.at(key), value);
    }
}

} // namespace
} // namespace tessera
