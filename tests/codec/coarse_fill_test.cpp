// Coarser levels replace the missing tiles of partial and damaged files.
#include "codec/decoder.h"
#include "format/io/crc32c.h"
#include "format/tile/colour_transform.h"
#include "format/work.h"
#include "tests/reference/spec_decoder.h"
#include "tests/support/layered_files.h"
#include "tests/support/random.h"

#include <atomic>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace tessera {
namespace {

using namespace tessera::test::layered_files;

using namespace test;

double psnr(const Bytes& a, const Bytes& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = std::to_integer<int>(a[i]) - std::to_integer<int>(b[i]);
        sum += d * d;
    }
    return 10 * std::log10(65025.0 * static_cast<double>(a.size()) / std::max(sum, 1e-9));
}

TEST(Partial, PrefixesWithTheIndexDecode) {
    const Layered& layered = shared_file();
    const auto whole_source = wrap_memory(layered.file);
    const auto whole = Decoder::open(*whole_source);
    ASSERT_TRUE(whole.ok());
    const Bytes texels = texels_of(*whole, Box4::whole(scene_size));
    const ContainerReader& container = whole->container();
    std::uint64_t data = 0;
    for (const SectionInfo& section : container.sections())
        if (section.type == "DATA")
            data = section.offset;
    double last = 0;
    std::uint64_t least_missing = container.grid().tiles() + 1;
    const std::size_t step = (layered.file.size() - data) / 23 + 1;
    for (std::size_t length = data; length <= layered.file.size(); length += step) {
        const auto part = wrap_memory(std::span(layered.file).first(length));
        EXPECT_EQ(Decoder::open(*part).status().code(), ErrorCode::invalid_file);
        const auto decoder = Decoder::open(*part, {true, false});
        ASSERT_TRUE(decoder.ok()) << decoder.status().message();
        const Bytes shown = texels_of(*decoder, Box4::whole(scene_size), 2);
        const double reached = psnr(shown, texels);
        EXPECT_GE(reached, last) << length;
        last = reached;
        const FillReport report = decoder->fill_report();
        EXPECT_LE(report.missing_tiles, least_missing);
        EXPECT_EQ(report.damaged_tiles, 0u);
        least_missing = report.missing_tiles;
        // Received tiles decode exactly.
        for (std::uint64_t tile = 0; tile < container.grid().tiles(); tile += 7) {
            if (!*decoder->container().is_received(tile))
                continue;
            const Box4 box = container.grid().box(tile);
            EXPECT_EQ(texels_of(*decoder, box), texels_of(*whole, box));
        }
        const auto findings = validate_container(*part, {}, {true});
        for (const Finding& finding : findings)
            EXPECT_FALSE(finding.fatal) << finding.text;
    }
    // The coarse levels alone show a preview that is better than the background colour.
    const auto first = wrap_memory(std::span(layered.file).first(container.locate(0)->offset));
    const auto coarse = Decoder::open(*first, {true, false});
    ASSERT_TRUE(coarse.ok());
    const double preview = psnr(texels_of(*coarse, Box4::whole(scene_size)), texels);
    const auto nothing = wrap_memory(std::span(layered.file).first(data));
    const auto background = Decoder::open(*nothing, {true, false});
    ASSERT_TRUE(background.ok());
    EXPECT_GT(preview, psnr(texels_of(*background, Box4::whole(scene_size)), texels) + 4);
    EXPECT_GT(preview, 20);
}

TEST(Partial, PrefixesThatCutTheIndexAreRefused) {
    const Layered& layered = shared_file();
    const auto source = wrap_memory(layered.file);
    const auto container = ContainerReader::open(*source);
    ASSERT_TRUE(container.ok());
    const std::uint64_t end = container->sections().back().offset;
    for (std::uint64_t length = 0; length < end; length += length < 300 ? 1 : 37) {
        const auto part = wrap_memory(std::span(layered.file).first(length));
        EXPECT_EQ(Decoder::open(*part, {true, true}).status().code(), ErrorCode::invalid_file)
            << length;
    }
}

TEST(DamagedLevels, CoarserLevelsFillDamagedTilesOnly) {
    const Layered& layered = shared_file();
    const auto good_source = wrap_memory(layered.file);
    const auto good = Decoder::open(*good_source);
    ASSERT_TRUE(good.ok());
    const ContainerReader& container = good->container();
    const std::uint64_t begin = container.sections()[container.sections().size() - 2].offset;
    Random random(77);
    for (int round = 0; round < 40; ++round) {
        Bytes file = layered.file;
        // The flipped bits lie in the index or the data, including the coarse levels.
        for (int flips = random.range(1, 4); flips > 0; --flips)
            file[begin + random() % (file.size() - begin)] ^=
                static_cast<std::byte>(1u << random() % 8);
        const auto source = wrap_memory(file);
        const auto decoder = Decoder::open(*source, {false, true});
        ASSERT_TRUE(decoder.ok()) << decoder.status().message();
        const Bytes shown = texels_of(*decoder, Box4::whole(scene_size), 2);
        const FillReport report = decoder->fill_report();
        EXPECT_EQ(report.missing_tiles, 0u);
        const std::set<std::uint64_t> filled(report.damaged.begin(), report.damaged.end());
        // The validator names exactly the tiles that were filled.
        std::set<std::uint64_t> named;
        for (const Finding& finding : validate_container(*source))
            for (std::uint64_t i = 0; i < finding.tile_count; ++i)
                if (finding.first_tile + i < container.grid().tiles())
                    named.insert(finding.first_tile + i);
        for (std::uint64_t tile = 0; tile < container.grid().tiles(); ++tile) {
            const Box4 box = container.grid().box(tile);
            Bytes part(container.desc().box_bytes(box));
            copy_box(box, Box4::whole(scene_size), shown, box, part, 3);
            // An empty tile has no page, but its index record may be damaged.
            if (report.damaged_tiles <= FillReport::most_listed)
                EXPECT_TRUE(filled.contains(tile) == named.contains(tile) ||
                            container.locate(tile)->length == 0)
                    << tile;
            if (!named.contains(tile))
                ASSERT_EQ(part, texels_of(*good, box)) << tile;
        }
        Bytes strict(shown.size());
        EXPECT_EQ(Decoder::open(*source)->decode_box(Box4::whole(scene_size), strict).code(),
                  named.empty() ? ErrorCode::ok : ErrorCode::invalid_file);
    }
}

TEST(DamagedLevels, AFlippedBitLosesOneTile) {
    auto plain = encode_scene("composed", {64, 32, 8, 8}, false, quick());
    ASSERT_TRUE(plain.ok());
    plain->file.back() ^= std::byte{1};
    const auto source = wrap_memory(plain->file);
    const auto decoder = Decoder::open(*source, {false, true});
    ASSERT_TRUE(decoder.ok());
    texels_of(*decoder, Box4::whole({64, 32, 8, 8}));
    const FillReport report = decoder->fill_report();
    ASSERT_EQ(report.damaged_tiles, 1u) << "each tile of about 400 bytes is a page of its own";
    const Box4 box = decoder->container().grid().box(report.damaged.front());
    const Bytes texels = texels_of(*decoder, box);
    const auto& background = decoder->container().header().background;
    for (std::size_t i = 0; i < texels.size(); ++i)
        ASSERT_EQ(std::to_integer<int>(texels[i]), background[i % 3]);
}

// tools/test.sh --sanitize thread also runs this under the thread sanitizer.
TEST(Threads, EightThreadsDecodeTheSameTexelsAsOne) {
    const Layered& layered = shared_file();
    Bytes damaged = layered.file;
    damaged[damaged.size() * 2 / 3] ^= std::byte{8};
    const auto source = wrap_memory(damaged);
    const auto shared = Decoder::open(*source, {false, true});
    ASSERT_TRUE(shared.ok());
    struct Job {
        Box4 box;
        std::uint32_t crc;
    };
    Random random(1000);
    std::vector<Job> jobs(1000);
    const auto single_source = wrap_memory(damaged);
    const auto single = Decoder::open(*single_source, {false, true});
    ASSERT_TRUE(single.ok());
    for (Job& job : jobs) {
        for (std::size_t axis = 0; axis < 4; ++axis) {
            const int n = static_cast<int>(scene_size[axis]);
            const int begin = random.range(0, n - 1);
            job.box.begin[axis] = static_cast<std::uint32_t>(begin);
            job.box.end[axis] =
                static_cast<std::uint32_t>(random.range(begin, std::min(n - 1, begin + 20)) + 1);
        }
        job.crc = crc32c(texels_of(*single, job.box));
    }
    std::atomic<std::size_t> next{0};
    std::atomic<int> wrong{0};
    {
        JoinedThreads threads;
        for (int i = 0; i < 8; ++i)
            threads.start([&] {
                for (std::size_t j; (j = next++) < jobs.size();) {
                    Bytes texels(shared->desc().box_bytes(jobs[j].box));
                    wrong +=
                        !shared->decode_box(jobs[j].box, texels, {.threads = j % 2 == 0 ? 1u : 2u})
                             .ok() ||
                        crc32c(texels) != jobs[j].crc;
                }
            });
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(shared->fill_report().damaged_tiles, single->fill_report().damaged_tiles);
    EXPECT_GT(shared->fill_report().damaged_tiles, 0u);
}

} // namespace
} // namespace tessera
