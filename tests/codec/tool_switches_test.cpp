// The switches of the coding tools.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/round_trips.h"
#include "tests/support/tool_words.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::round_trips;

using Kind = RateTarget::Kind;

// Coloured noise, smooth over two texels, that moves by half a texel per view along s and by one
// along t.
MemoryTexture texture_with_parallax(SampleType type) {
    Random random(12);
    std::vector<double> lattice;
    for (int i = 0; i < 3 * 64 * 64; ++i)
        lattice.push_back(random.unit());
    const double gain = type == SampleType::half16 ? 1000 : 1;
    return {
        describe(type == SampleType::half16 ? Extent4{17, 12, 5, 4} : Extent4{24, 16, 6, 5}, type),
        [=](int u, int v, int s, int t, int c) {
            const double x = 0.5 * (u + 0.5 * s) + 8, y = 0.5 * (v + t) + 8;
            const int i = static_cast<int>(x), j = static_cast<int>(y);
            const auto at = [&](int k, int l) {
                const auto place = static_cast<std::size_t>(l * 64 + k);
                return 0.7 * lattice[place] +
                       0.3 * lattice[(static_cast<std::size_t>(c) << 12) + place];
            };
            const double f = x - i, g = y - j;
            const double grain = (u * 7 + v * 13 + s * 29 + t * 31 + c * 3) % 17 / 17.0;
            return gain * (0.97 * ((1 - g) * ((1 - f) * at(i, j) + f * at(i + 1, j)) +
                                   g * ((1 - f) * at(i, j + 1) + f * at(i + 1, j + 1))) +
                           0.03 * grain);
        }};
}

// Section DATA of a file. Earlier sections record the options, so they differ anyway.
Bytes data_of(const Bytes& file) {
    const auto source = wrap_memory(file);
    const Result<ContainerReader> reader = ContainerReader::open(*source);
    EXPECT_TRUE(reader) << reader.status().message();
    const SectionInfo& data = reader->sections().back();
    EXPECT_EQ(data.type, "DATA");
    const auto begin = file.begin() + static_cast<std::ptrdiff_t>(data.offset);
    return {begin, begin + static_cast<std::ptrdiff_t>(data.length)};
}

TEST(Tools, EachChangesTheFileAndItStillDecodes) {
    for (const SampleType type : types) {
        MemoryTexture texture = texture_with_parallax(type);
        SwitchedOptions all{options_for({Kind::quality, 70}, usual_effort), {}};
        all.tile_extent = {16, 16, 4, 4};
        // Trials of dense tables take most of the time. Aligned views would have nothing to copy.
        all.tools = "-dense-tables,-align";
        const Encoded full = encode(texture, all);
        const auto check = [&](const std::string& name) {
            SwitchedOptions options = all;
            options.tools =
                name == "-dense-tables" ? "+dense-tables,-align" : all.tools + "," + name;
            const Encoded encoded = encode(texture, options);
            // These tools may have no effect on this texture. prediction_test.cpp,
            // tree_edits_test.cpp, tile_filter_test.cpp and pictures_test.cpp test them.
            constexpr std::array may_not_matter = {
                "-smooth",     "-base",           "-refine",     "-filter",
                "-borders",    "-picture-splits", "-sines",      "-planar",
                "-directions", "-no-transform",   "-plane-trees"};
            if (std::ranges::find(may_not_matter, name) == may_not_matter.end()) {
                EXPECT_FALSE(data_of(encoded.file) == data_of(full.file)) << name;
            }
            const Bytes texels = decode_all(encoded.file, texture.desc());
            const Difference d = difference(texture.texels, texels, type);
            EXPECT_NEAR(encoded.report.psnr, d.psnr, 1e-9) << name;
            EXPECT_NEAR(encoded.report.psnr, full.report.psnr, 2.5) << name;
            if (type == SampleType::half16) // one type suffices for the threads
                return;
            options.threads = 3;
            EXPECT_EQ(encode(texture, options).file, encoded.file) << name;
        };
        for (const std::string name : coding_tool_names)
            if (name != "align") // alignment_test.cpp
                check("-" + name);
        check("none");
    }
}

// A bowl beside slanted stripes, so that each tool pays somewhere.
TEST(Tools, OfPicturesChangeThem) {
    Random random(4);
    std::vector<double> grain;
    for (int i = 0; i < 64 * 48; ++i)
        grain.push_back(random.unit());
    MemoryTexture picture{
        describe(Extent4{64, 48, 1, 1}, SampleType::unorm8), [&](int u, int v, int, int, int c) {
            const double x = u - 40, y = v - 50;
            const bool is_stripe = (2 * u + 3 * v) / 24 % 2 == 0;
            const double stripes =
                0.3 + (is_stripe ? 0.35 - 0.05 * c : 0.0) + (v == 30 ? 0.2 : 0.0);
            const double bowl = 0.15 + 0.55 * (x * x + y * y) / 4100 - 0.05 * c;
            return (u < 36 ? bowl : stripes) + 0.03 * grain[static_cast<std::size_t>(v * 64 + u)];
        }};
    const auto data = [&](const std::string& tools) {
        const SwitchedOptions options{options_for({Kind::quality, 70}, usual_effort), tools};
        const Encoded encoded = encode(picture, options);
        const Bytes texels = decode_all(encoded.file, picture.desc());
        EXPECT_NEAR(encoded.report.psnr,
                    difference(picture.texels, texels, SampleType::unorm8).psnr, 1e-9)
            << tools;
        return data_of(encoded.file);
    };
    const Bytes full = data("");
    for (const std::string name : {"borders", "planar", "directions", "sines", "picture-splits",
                                   "no-transform", "chroma-from-luma", "rotation"})
        EXPECT_FALSE(data("-" + name) == full) << name;
}

TEST(Tools, SwitchesOverrideTheEffort) {
    for (std::size_t i = 0; i < coding_tool_names.size(); ++i)
        for (const bool of_effort : {false, true}) {
            const auto tool = static_cast<CodingTool>(i);
            const std::string name = coding_tool_names[i];
            const auto is_on = [&](const std::string& words) {
                return tool_switches(words).is_on(tool, of_effort);
            };
            EXPECT_EQ(is_on(""), of_effort) << name;
            EXPECT_TRUE(is_on("all")) << name;
            EXPECT_FALSE(is_on("none")) << name;
            EXPECT_TRUE(is_on("none,+" + name)) << "the last word counts";
            EXPECT_FALSE(is_on("+" + name + ",-" + name)) << name;
        }
    EXPECT_FALSE(tool_switches("none,+copies").is_on(CodingTool::half, true));
}

TEST(Tools, WorkAtAnyEffort) {
    MemoryTexture texture = texture_with_parallax(SampleType::unorm8);
    const auto without = [&](int effort) {
        const SwitchedOptions options{options_for({Kind::quality, 70}, effort), "none"};
        return data_of(encode(texture, options).file);
    };
    EXPECT_TRUE(without(0) == without(most_effort)); // nothing is left for an effort to choose
    const Encoded fastest = encode(texture, options_for({Kind::quality, 70}, 0));
    for (const char* tools : {"+copies", "+rotation", "+dependent", "+fitted-tables", "+grids"}) {
        const SwitchedOptions options{options_for({Kind::quality, 70}, 0), tools};
        const Encoded encoded = encode(texture, options);
        EXPECT_FALSE(data_of(encoded.file) == data_of(fastest.file)) << tools;
        const Bytes texels = decode_all(encoded.file, texture.desc());
        EXPECT_NEAR(encoded.report.psnr,
                    difference(texture.texels, texels, SampleType::unorm8).psnr, 1e-9);
    }
}

TEST(Tools, KeepTheMaximumError) {
    MemoryTexture texture = texture_with_parallax(SampleType::unorm8);
    const SwitchedOptions options{options_for({Kind::max_error, 2}, 3), "none"};
    const Encoded encoded = encode(texture, options);
    EXPECT_LE(
        difference(texture.texels, decode_all(encoded.file, texture.desc()), SampleType::unorm8)
            .largest,
        2);
}

} // namespace
} // namespace tessera::test
