// Tests that containers of every kind are read as they were written.
#include "format/container/container_writer.h"
#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "tests/support/container_samples.h"
#include "tests/support/vector_sink.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test;

using Bytes = std::vector<std::byte>;

void expect_round_trip(const Sample& sample) {
    const Bytes file = sample.write();
    const auto source = wrap_memory(file);
    const Result<ContainerReader> reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader) << reader.status().message();
    ASSERT_EQ(reader->tile_count(), sample.tiles.size());
    for (std::size_t i = 0; i < sample.tiles.size(); ++i) {
        Bytes plain, checked;
        ASSERT_TRUE(reader->read_tile(i, plain));
        ASSERT_TRUE(reader->read_tile_checked(i, checked));
        ASSERT_EQ(plain, sample.tiles[i]);
        ASSERT_EQ(checked, sample.tiles[i]);
        ASSERT_EQ(reader->locate(i)->length, sample.tiles[i].size());
    }
    EXPECT_TRUE(reader->validate().empty());
    EXPECT_EQ(reader->locate(sample.tiles.size()).status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(reader->group(reader->group_count()).status().code(), ErrorCode::bad_argument);
}

TEST(ContainerWriter, RoundTripOfManySizes) {
    for (const std::size_t count : {1u, 2u, 255u, 256u, 257u, 512u, 1000u})
        expect_round_trip(Sample(random_tiles(count, static_cast<std::uint32_t>(count))));
    expect_round_trip(Sample(std::vector<Bytes>(600))); // all background: DATA is empty
    expect_round_trip(Sample({Bytes(1)}));
}

TEST(ContainerWriter, RoundTripOfLargeTiles) {
    for (const std::uint32_t page_bytes : {256u, 4096u, 65536u}) {
        Sample sample(random_tiles(300, page_bytes, true));
        sample.contents.page_bytes = page_bytes;
        expect_round_trip(sample);
    }
    for (const std::uint32_t page_bytes : {0u, 16u}) {
        Sample sample(random_tiles(300, page_bytes));
        sample.contents.page_bytes = page_bytes;
        expect_round_trip(sample);
    }
    Sample sample(random_tiles(20, 9));
    for (const std::size_t length : {65536u, 65537u, 131072u, 131073u, 65535u})
        sample.tiles[length % 20] = Random(8).bytes(length);
    expect_round_trip(sample);
}

// By default, pages are as small as possible while their checksums stay below 1 % of the tiles'
// bytes.
TEST(ContainerWriter, PagesAreAsSmallAsOnePercentAllows) {
    const auto page_bytes = [](const std::vector<Bytes>& tiles) {
        const Bytes file = Sample(tiles).write();
        return ContainerReader::open(*wrap_memory(file))->header().page_bytes();
    };
    EXPECT_EQ(page_bytes(std::vector<Bytes>(300, Bytes(400))), 0u);
    EXPECT_EQ(page_bytes(std::vector<Bytes>(300, Bytes(399))), 1024u) << "two tiles per page";
    EXPECT_EQ(page_bytes(std::vector<Bytes>(300, Bytes(200))), 512u);
    EXPECT_EQ(page_bytes(std::vector<Bytes>(256, Bytes(10))), 512u);
    EXPECT_EQ(page_bytes(std::vector<Bytes>(10, Bytes(1))), 1024u) << "larger pages save nothing";
    EXPECT_EQ(page_bytes(std::vector<Bytes>(10)), 0u) << "no pages without bytes";
}

TEST(ContainerWriter, ThousandGroups) {
    std::vector<Bytes> tiles(256 * 1000 - 3);
    for (std::size_t i = 0; i < tiles.size(); i += 97)
        tiles[i] = Bytes(1 + i % 50, static_cast<std::byte>(i & 0xFF));
    const Sample sample(std::move(tiles));
    const Bytes file = sample.write();
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->group_count(), 1000u);
    for (std::size_t i = 0; i < sample.tiles.size(); i += 89) {
        Bytes tile;
        ASSERT_TRUE(reader->read_tile_checked(i, tile));
        ASSERT_EQ(tile, sample.tiles[i]);
    }
    EXPECT_TRUE(reader->validate().empty());
}

TEST(ContainerWriter, HeaderFieldsSurvive) {
    auto sample = rich_sample();
    ContainerContents& c = sample->contents;
    c.desc = {{43, 3, 2, 1}, SampleType::half16, 4};
    c.description = {Proxy::sphere,
                     SurfaceMap::sphere_longitude_latitude,
                     AngularMap::planar_views,
                     Transfer::linear,
                     Primaries::bt709,
                     AlphaMode::premultiplied,
                     {1, -2, 3.5},
                     4,
                     {5, 6}};
    c.proxy_mesh = {};
    c.colour = ColourTransform::ycocg_r;
    c.background = {0x3C00, 0, 0x7BFF, 0xBC00};
    c.required_features = feature_corrections;
    const Bytes file = sample->write();
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader) << reader.status().message();
    EXPECT_EQ(reader->desc(), c.desc);
    EXPECT_EQ(reader->description(), c.description);
    EXPECT_EQ(reader->metadata(), c.metadata);
    EXPECT_EQ(reader->header().colour, c.colour);
    EXPECT_EQ(reader->header().background, c.background);
    EXPECT_EQ(reader->header().required_features, feature_corrections);
    EXPECT_EQ(reader->header().page_bytes(), 256u);
    EXPECT_EQ(reader->header().tile_extent, c.tile_extent);
    EXPECT_EQ(reader->grid().count(), c.desc.size);
    EXPECT_EQ(reader->levels().size(), 1u);
    EXPECT_TRUE(std::ranges::equal(reader->codec_parameters(), sample->code));
    EXPECT_TRUE(std::ranges::equal(reader->section_bytes("xtra"), c.extra[0].bytes));
    EXPECT_TRUE(reader->section_bytes("none").empty());
    EXPECT_EQ(reader->sections().size(), 7u); // with geom, ROOT, INDX and DATA
    EXPECT_EQ(reader->sections()[0].type, "meta");
}

// A small file has no section that says nothing.
TEST(ContainerWriter, SmallFilesHaveShortHeads) {
    Sample sample({Bytes(5)});
    EXPECT_EQ(sample.write().size(), header_bytes + section_entry_bytes + 40 + 10 + 5);
    sample.contents.description.viewing_radius[1] = 1;
    EXPECT_EQ(sample.write().size(), header_bytes + 2 * section_entry_bytes + 40 + 24 + 10 + 5);
}

TEST(ContainerWriter, SameContentsGiveSameBytes) {
    EXPECT_EQ(rich_sample()->write(), rich_sample()->write());
    auto other = rich_sample();
    other->tiles[257][0] ^= std::byte{1};
    const Bytes a = rich_sample()->write(), b = other->write();
    EXPECT_FALSE(std::equal(a.begin() + 80, a.begin() + 88, b.begin() + 80)) << "same identity";
}

TEST(ContainerWriter, RefusesWhatReadersRefuse) {
    const auto refused = [](auto change) {
        auto sample = rich_sample();
        change(sample->contents);
        Bytes out;
        VectorSink sink(out);
        const ErrorCode planned = container_bytes(sample->contents).status().code();
        const ErrorCode written = write_container(sample->contents, sink).status().code();
        return planned == ErrorCode::bad_argument && written == planned && out.empty();
    };
    EXPECT_TRUE(refused([](auto& c) { c.page_bytes = 255; }));
    EXPECT_TRUE(refused([](auto& c) { c.page_bytes = 264; }));
    EXPECT_TRUE(refused([](auto& c) { c.page_bytes = 65552; }));
    EXPECT_TRUE(refused([](auto& c) { c.tile_extent[1] = 0; }));
    EXPECT_TRUE(refused([](auto& c) { c.tile_extent = {32, 32, 32, 32}; }));
    EXPECT_TRUE(refused([](auto& c) { c.desc.size = {1u << 20, 1u << 13, 1, 1}; })) << "many tiles";
    EXPECT_TRUE(refused([](auto& c) { c.desc.channels = 5; }));
    EXPECT_TRUE(refused([](auto& c) { c.description.sphere_radius = 1; })) << "no sphere";
    EXPECT_TRUE(refused([](auto& c) { c.required_features = 1; }));
    EXPECT_TRUE(refused([](auto& c) { c.background[3] = 1; }));
    EXPECT_TRUE(refused([](auto& c) { c.description.proxy = Proxy::none; })) << "mesh data";
    EXPECT_TRUE(refused([](auto& c) { c.extra[0].type = "CODE"; }));
    EXPECT_TRUE(refused([](auto& c) { c.extra[0].type = "abc"; }));
    EXPECT_TRUE(refused([](auto& c) { c.extra.push_back(c.extra[0]); }));
    EXPECT_TRUE(refused([](auto& c) { c.metadata[""] = "x"; }));
}

TEST(ContainerWriter, AcceptsTheLargestTileAndTheMostSections) {
    Sample tiles({Bytes()});
    const std::size_t longest =
        (1u << 18) + 16 * tiles.contents.desc.channels * texel_count(tiles.contents.tile_extent);
    tiles.tiles[0].resize(longest);
    EXPECT_TRUE(container_bytes(tiles.contents));
    tiles.tiles[0].resize(longest + 1);
    EXPECT_EQ(container_bytes(tiles.contents).status().code(), ErrorCode::unsupported);

    constexpr std::size_t most = 64;
    Sample sections(random_tiles(1, 1));
    const std::size_t own = [&] {
        const Bytes file = sections.write();
        return ContainerReader::open(*wrap_memory(file))->sections().size();
    }();
    for (std::size_t i = own; i < most; ++i)
        sections.contents.extra.push_back(
            {{'x', static_cast<char>('a' + i / 8), static_cast<char>('a' + i % 8), 'x'}, {}});
    const Bytes file = sections.write();
    const auto reader = ContainerReader::open(*wrap_memory(file));
    ASSERT_TRUE(reader) << reader.status().message();
    EXPECT_EQ(reader->sections().size(), most);
    sections.contents.extra.push_back({"more", {}});
    EXPECT_EQ(container_bytes(sections.contents).status().code(), ErrorCode::bad_argument);
}

TEST(ContainerWriter, ReturnsErrorsOfTheSink) {
    struct FullSink : ByteSink {
        Status append(std::span<const std::byte>) override { return {ErrorCode::io, "full"}; }
    } sink;
    EXPECT_EQ(write_container(rich_sample()->contents, sink).status().code(), ErrorCode::io);
}

} // namespace
} // namespace tessera
