// The frozen files in tests/golden must always decode to the same texels.
#include "corpus/bake.h"
#include "tests/reference/agreement.h"
#include "tests/support/efforts.h"
#include "tests/support/fnv1a.h"
#include "tests/support/moving_views.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace tessera {
namespace {

using namespace test;

std::filesystem::path golden(const std::string& name) {
    return std::filesystem::path(__FILE__).parent_path().parent_path() / "golden" / name;
}

// Rewrites tests/golden, as tests/golden/README.md explains.
void regenerate_golden() {
    std::ofstream manifest(golden("manifest.txt"));
    const auto write = [&](const std::string& name, TexelSource& source, RateTarget rate,
                           Extent4 tile_extent, std::optional<int> effort = {}) {
        const Bytes file =
            encode(source, rate, tile_extent, {{"Software", "golden"}, {"Title", name}}, effort);
        std::ofstream(golden(name), std::ios::binary)
            .write(reinterpret_cast<const char*>(file.data()),
                   static_cast<std::streamsize>(file.size()));
        const Outcome outcome = by_reference(file);
        ASSERT_TRUE(outcome.accepted) << outcome.error;
        manifest << name << ' ' << std::hex << fnv1a_64(outcome.texels) << '\n';
    };
    const auto scene = [&](const std::string& name, const char* of, Extent4 size, RateTarget rate,
                           Extent4 tile_extent) {
        auto source = corpus::make_baked_source(of, size, 2, 1);
        ASSERT_TRUE(source) << source.status().message();
        write(name, **source, rate, tile_extent);
    };
    const auto texture = [&](const std::string& name, const char* of, Extent4 size, int channels,
                             SampleType type, RateTarget rate, Extent4 tile_extent) {
        CodeTexture source = make_texture(of, size, channels, type);
        write(name, source, rate, tile_extent);
    };
    const SampleType unorm8 = SampleType::unorm8, half16 = SampleType::half16;
    // A picture that moves by half a texel per view, in opposite directions along u and v.
    CodeTexture views({{24, 24, 5, 5}, unorm8, 3},
                      [](double u, double v, double s, double t, int c) {
                          const double x = 24 * u + 2.5 * s, y = 24 * v - 2.5 * t;
                          return 0.5 + 0.2 * std::sin(x * 1.7 + c) * std::cos(y * 1.3) +
                                 0.15 * std::sin(x * 0.9 + y * 2.1 + 2 * c);
                      });
    write("rgb8_views.tess", views, {Kind::quality, 60}, {24, 24, 5, 5}, usual_effort);
    // A picture that moves by two and a half texels per view, or by half a texel in the aligned
    // grid. Its tiles have base pictures.
    CodeTexture aligned(
        {{40, 36, 4, 3}, unorm8, 3}, [](double u, double v, double s, double t, int c) {
            return test::moving_picture(40 * u - 10 * s + 0.75, 36 * v + 7.5 * t - 1.75, c);
        });
    write("rgb8_aligned.tess", aligned, {Kind::quality, 60}, {24, 24, 4, 3}, usual_effort);
    // Two halves of a picture that move in opposite directions.
    CodeTexture large({{64, 64, 5, 4}, unorm8, 3},
                      [](double u, double v, double s, double t, int c) {
                          const double by = v < 0.5 ? 7.5 : -7.5;
                          return test::moving_picture(64 * u + by * s, 64 * v + 0.75 * by * t, c);
                      });
    write("rgb8_large.tess", large, {Kind::quality, 60}, {64, 64, 5, 4}, usual_effort);
    // The file of format/EXAMPLE.md: one tile of two blocks, one for each view, and an empty tile.
    CodeTexture example({{8, 4, 2, 1}, unorm8, 1}, [](double u, double v, double s, double, int) {
        return u > 0.5 ? 0.0 : (s > 0.5 ? 100 : 17.5 + 120 * u + 40 * v) / 255;
    });
    write("example.tess", example, {Kind::quality, 60}, {4, 4, 2, 1}, 0);
    scene("rgb8.tess", "composed", {32, 16, 8, 8}, {Kind::quality, 60}, {32, 32, 8, 8});
    scene("rgb8_tiles.tess", "gallery", {13, 7, 5, 6}, {Kind::quality, 60}, {5, 7, 3, 2});
    scene("rgb8_bounded.tess", "mirror", {10, 8, 6, 5}, {Kind::max_error, 3}, {8, 8, 4, 4});
    scene("rgb_half.tess", "lamps", {16, 16, 4, 4}, {Kind::quality, 50}, {16, 16, 4, 4});
    texture("grey8.tess", "waves", {17, 9, 5, 3}, 1, unorm8, {Kind::quality, 80}, {32, 32, 8, 8});
    auto rgb = corpus::make_baked_source("composed", {16, 12, 6, 6}, 2, 1);
    ASSERT_TRUE(rgb) << rgb.status().message();
    WithAlpha rgba(**rgb);
    write("rgba8.tess", rgba, {Kind::quality, 60}, {32, 32, 8, 8});
    texture("grey_alpha_half_lossless.tess", "signed", {5, 4, 3, 3}, 2, half16,
            {Kind::max_error, 0}, {8, 8, 4, 4});
    texture("rgb8_lossless.tess", "noise", {5, 5, 5, 5}, 3, unorm8, {Kind::max_error, 0},
            {8, 8, 8, 8});
    texture("rgb_half_stored.tess", "noise", {6, 6, 3, 3}, 3, half16, {Kind::max_error, 0},
            {3, 6, 3, 3});
    texture("background.tess", "constant", {40, 20, 16, 8}, 3, unorm8, {Kind::quality, 75},
            {8, 8, 4, 4});
    CodeTexture picture({{150, 83, 1, 1}, unorm8, 3},
                        [](double u, double v, double, double, int c) {
                            return test::moving_picture(150 * u, 83 * v, c);
                        });
    write("picture8.tess", picture, {Kind::quality, 60}, {150, 83, 1, 1}, usual_effort);
    // Isolated bright texels and lines, which are coded without a transform.
    CodeTexture dots({{96, 64, 1, 1}, unorm8, 3}, [](double u, double v, double, double, int c) {
        const int x = static_cast<int>(96 * u), y = static_cast<int>(64 * v);
        const bool is_bright = (x * 7 + y * 13) % 41 == 0 || (x < 48 && y % 9 == 4);
        return 0.3 + 0.1 * u + (is_bright ? 0.2 + 0.1 * c : 0.0);
    });
    write("picture8_plain.tess", dots, {Kind::quality, 60}, {96, 64, 1, 1}, most_effort);
    // Lines that the second channel alone shows, so that its transforms follow no first plane.
    CodeTexture lines({{96, 64, 1, 1}, unorm8, 2}, [](double u, double v, double, double, int c) {
        const int x = static_cast<int>(96 * u), y = static_cast<int>(64 * v);
        return 0.5 + (c == 0 ? 0.1 * (x > 60 && x % 7 == 3) : 0.15 * (y % 9 == 4) - 0.1 * v);
    });
    write("picture8_pair.tess", lines, {Kind::quality, 60}, {96, 64, 1, 1}, most_effort);
    // Slanted edges in one channel and finer ones in the other, and a second tile whose channels have
    // the same edges.
    CodeTexture edges({{150, 70, 1, 1}, unorm8, 2}, [](double u, double v, double, double, int c) {
        const double x = 150 * u, y = 70 * v;
        const bool is_alike = x > 75;
        const double slope = c == 0 || is_alike ? 2 * x + y : x - 3 * y;
        return 0.5 +
               (std::fmod(std::fabs(slope), c == 0 || is_alike ? 40.0 : 23.0) < 9 ? 0.2 : 0.0);
    });
    write("picture8_planes.tess", edges, {Kind::quality, 60}, {75, 70, 1, 1}, most_effort);
    CodeTexture bright({{40, 33, 1, 1}, half16, 4}, [](double u, double v, double, double, int c) {
        return c == 3 ? v : 40 * test::moving_picture(20 * u, 16 * v, c) - 12;
    });
    write("picture_half.tess", bright, {Kind::quality, 50}, {32, 40, 1, 1}, most_effort);
    texture("sparse8.tess", "sparse", {40, 20, 3, 3}, 3, unorm8, {Kind::quality, 40}, {8, 8, 4, 4});
}

TEST(GoldenFiles, DecodeToTheFrozenTexels) {
    if (std::getenv("TESSERA_REGENERATE_GOLDEN"))
        regenerate_golden();
    std::ifstream manifest(golden("manifest.txt"));
    std::string name;
    std::uint64_t want = 0;
    int count = 0;
    while (manifest >> name >> std::hex >> want) {
        std::ifstream in(golden(name), std::ios::binary);
        const std::string content((std::istreambuf_iterator<char>(in)), {});
        const auto bytes = std::as_bytes(std::span(content));
        const Bytes file(bytes.begin(), bytes.end());
        const Outcome library = by_library(file), specification = by_reference(file);
        EXPECT_TRUE(library.accepted) << name << ": " << library.error;
        EXPECT_TRUE(specification.accepted) << name << ": " << specification.error;
        EXPECT_EQ(fnv1a_64(library.texels), want) << name;
        EXPECT_EQ(fnv1a_64(specification.texels), want) << name;
        EXPECT_EQ(specification.metadata.count("Title"), 1u) << name;
        ++count;
    }
    EXPECT_EQ(count, 20);
}

} // namespace
} // namespace tessera
