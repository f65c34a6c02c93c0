// Tests drawing planar views on the CPU. How views are arranged in a file's tiles must not affect
// the picture.
#include "codec/encoder.h"
#include "tests/support/moving_views.h"
#include "tests/support/rendering.h"
#include "tests/support/tool_words.h"
#include "tools/view/planar_renderer.h"

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <set>
#include <tuple>

namespace tessera {
namespace {

using namespace tessera::test::rendering;

class PlanarRender : public Render {
protected:
    // Writes a lossless file of views that move by (u, v) texels. `tools` decides whether they are
    // aligned.
    std::string views_file(const std::string& name, const TextureDesc& desc, int u, int v,
                           const std::string& tools) {
        test::MemoryTexture texture = test::moving_views(desc, u, v);
        test::SwitchedOptions options;
        options.rate = {RateTarget::Kind::max_error, 0};
        options.effort = test::copies_effort;
        options.threads = 1;
        options.tile_extent = {16, 16, 4, 3};
        options.tools = tools;
        options.description.angular_map = AngularMap::planar_views;
        options.metadata = {{"Cameras", "0.3,0.2,3,2"}};
        test::Bytes file;
        EXPECT_TRUE(encode_memory(texture, file, options));
        std::ofstream(at(name), std::ios::binary)
            .write(reinterpret_cast<const char*>(file.data()),
                   static_cast<std::streamsize>(file.size()));
        const auto bytes = open_file(at(name));
        EXPECT_EQ(ContainerReader::open(**bytes)->alignment().any(), tools.empty()) << name;
        return at(name);
    }
    // The window fills the picture, because files have different backgrounds outside of it.
    std::string drawn(const std::string& file, std::vector<std::string> words) {
        const std::string output = at("v.exr"); // floats, because 8 bits could hide differences
        words.insert(words.begin(), {file, "-o", output, "-q", "--pixels", "36x30"});
        const Status status = run(words);
        EXPECT_TRUE(status) << status.message();
        std::ifstream in(output, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
};

TEST_F(PlanarRender, AlignedViewsAreDrawnUnchanged) {
    const std::vector<std::vector<std::string>> poses = {
        {},                                                        // in the middle of the cameras
        {"--eye=0.45,-0.2,3"},                                     // at the last camera
        {"--eye=-0.37,0.11,2.6", "--focus", "4"},                  // between four of them
        {"--eye=5,-4,6"},                                          // beyond all of them
        {"--eye=0.2,0.3,1.5", "--look=-0.87,0.7,0", "--fov", "8"}, // at a corner
    };
    const TextureDesc desc{{48, 40, 4, 3}, SampleType::unorm8, 3};
    const std::string aligned = views_file("a.tess", desc, 2, -2, "");
    const std::string plain = views_file("p.tess", desc, 2, -2, "-align");
    std::string last;
    for (const auto& pose : poses) {
        const std::string picture = drawn(aligned, pose);
        EXPECT_EQ(picture == drawn(plain, pose), true) << testing::PrintToString(pose);
        EXPECT_NE(picture == last, true);
        last = picture;
    }
}

constexpr Extent4 asked_block{8, 8, 2, 2};

// Texels of a tile grid. Records which blocks are read.
class AskedTexels final : public TexelSource {
public:
    explicit AskedTexels(const TextureDesc& desc) : desc_(desc) {}
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        std::ranges::fill(out, std::byte{1});
        blocks.insert(TileGrid(desc_.size, asked_block).tiles_touched(box).front());
        return {};
    }
    std::set<std::uint64_t> blocks;

private:
    TextureDesc desc_;
};

// If requests are expensive, the blocks that a view needs are announced before they are read.
TEST_F(PlanarRender, NeededTilesAreAnnounced) {
    const AlignedViews aligned({40, 36, 3, 2}, {7, -5});
    AskedTexels source({aligned.grid_size(), SampleType::unorm8, 1});
    RenderOptions options;
    options.threads = 1;
    std::set<std::uint64_t> told;
    options.foretell = [&told](std::span<const std::uint64_t> blocks) {
        told.insert(blocks.begin(), blocks.end());
        return Status();
    };
    const PlanarViews views{{0.3, 0.2, 3, 2}, 3};
    const auto renderer = make_planar_renderer(source, asked_block, views, aligned, grey, options);
    view_of(*renderer, window_camera({0.1, 0.05, 3}, views.cameras, {40, 36, 3, 2}, 80, 72));
    EXPECT_EQ(source.blocks, told);
    EXPECT_GT(told.size(), 20u);
}

// Compares a file of aligned views with one whose views are not aligned, in both directions.
TEST_F(PlanarRender, AlignedViewsAreComparedWithOthers) {
    const TextureDesc desc{{40, 36, 3, 2}, SampleType::unorm8, 1};
    const std::string aligned = views_file("a.tess", desc, 2, 2, "");
    const std::string plain = views_file("p.tess", desc, 2, 2, "-align");
    for (const auto& [file, original] : {std::pair(aligned, plain), std::pair(plain, aligned)}) {
        const Status status = run({file, "-o", at("v.png"), "--pixels", "31x24", "--eye=0.4,0.3,2",
                                   "--original", original, "--json"});
        ASSERT_TRUE(status) << status.message();
        EXPECT_NE(out_.find("\"psnr\": null"), std::string::npos) << out_; // identical
    }
}

} // namespace
} // namespace tessera
