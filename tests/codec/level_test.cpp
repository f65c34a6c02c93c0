// Coarse levels: their numbering, means and interpolation, files that hold them, beginnings of such
// files, damage that they stand in for, and readers on many threads.
#include "format/container/syntax.h"
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/texels/level_texels.h"
#include "corpus/bake.h"
#include "format/io/crc32c.h"
#include "format/tile/colour_transform.h"
#include "tests/support/codec_test_support.h"
#include "tests/reference/spec_decoder.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <thread>

namespace tessera {
namespace {

using namespace test;
namespace reference = tessera_reference;

// ---------------------------------------------------------------- numbering

std::vector<LevelEntry> some_levels(const Extent4& size) {
    return {LevelEntry{size, 0, 0, 0}, coarse_level(size, 1, 0, 2), coarse_level(size, 3, 1, 4)};
}

TEST(LevelTable, GroupsHoldEveryTileOnceTheCoarsestLevelFirst) {
    const auto table = LevelTable::make(some_levels({70, 33, 17, 9}), {4, 4, 4, 4});
    ASSERT_TRUE(table.ok()) << table.status().message();
    std::vector<int> seen(table->tile_count());
    std::uint64_t last_level_first = table->levels().back().first_tile;
    EXPECT_EQ(table->tiles_of(0).first, last_level_first);
    for (std::uint32_t group = 0; group < table->group_count(); ++group) {
        const GroupTiles tiles = table->tiles_of(group);
        ASSERT_GE(tiles.count, 1u);
        ASSERT_LE(tiles.count, 256u);
        for (std::uint64_t t = tiles.first; t < tiles.first + tiles.count; ++t) {
            ++seen[t];
            EXPECT_EQ(table->group_of(t), group);
        }
        EXPECT_EQ(&table->level_of(tiles.first), &table->level_of(tiles.first + tiles.count - 1));
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
}

TEST(LevelTable, RefusesLevelsThatAreNoCoarserCopies) {
    const Extent4 size{70, 33, 17, 9}, tile{32, 32, 8, 8};
    const auto refused = [&](std::vector<LevelEntry> entries) {
        const Status status = LevelTable::make(entries, tile).status();
        EXPECT_EQ(status.code(), ErrorCode::invalid_file);
        EXPECT_NE(status.message().find("LEVL"), std::string::npos) << status.message();
    };
    auto levels = some_levels(size);
    levels[1].size[2] += 1;
    refused(levels);
    levels = some_levels(size);
    std::swap(levels[1], levels[2]);
    refused(levels);
    levels = some_levels(size);
    levels[2] = levels[1];
    refused(levels);
    levels = some_levels(size);
    levels[2].step_shift = 16;
    refused(levels);
    levels = some_levels(size);
    levels[0].step_shift = 1;
    refused(levels);
    levels = some_levels(size);
    levels[2].spatial_lod = 21;
    refused(levels);
    EXPECT_FALSE(read_levels(Bytes(25)).ok());
    EXPECT_FALSE(read_levels({}).ok());
    Bytes section = write_levels(some_levels(size));
    ASSERT_TRUE(read_levels(section).ok());
    EXPECT_EQ(*read_levels(section), some_levels(size));
    section[24 + 18] = std::byte{1};
    EXPECT_FALSE(read_levels(section).ok());
}

// ---------------------------------------------------------------- means and interpolation

// The definitions of FORMAT.md 5.4, texel by texel.
double mean_of(const MemoryTexture& texture, const LevelEntry& level, const Extent4& at, int c) {
    const TextureDesc& desc = texture.desc();
    double sum = 0, count = 0;
    Box4 box = covered_by({at, {at[0] + 1, at[1] + 1, at[2] + 1, at[3] + 1}}, level,
                          LevelEntry{desc.size, 0, 0, 0});
    Bytes texels(desc.box_bytes(box));
    MemoryTexture copy = texture;
    EXPECT_TRUE(copy.read(box, texels).ok());
    const std::size_t bytes = sample_bytes(desc.type);
    for (std::size_t i = static_cast<std::size_t>(c) * bytes; i < texels.size();
         i += desc.texel_bytes(), ++count)
        sum += sample_code(load_sample(texels.data() + i, desc.type), desc.type);
    return sum / count;
}

TEST(LevelTexels, MeansAreThoseOfTheTexelsThatAreJoined) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        const TextureDesc desc{{21, 10, 5, 7}, type, 3};
        Random random(5);
        MemoryTexture texture(desc, [&](int, int, int, int, int) { return random.unit() - 0.3; });
        const LevelEntry level = coarse_level(desc.size, 2, 1, 0), full{desc.size, 0, 0, 0};
        const Box4 box{{1, 0, 1, 0}, level.size};
        LevelMeans means(desc, full, level, box);
        // In pieces, as tiles come.
        const TileGrid grid(desc.size, {8, 4, 3, 2});
        for (std::uint64_t i = 0; i < grid.tiles(); ++i) {
            Bytes texels(desc.box_bytes(grid.box(i)));
            ASSERT_TRUE(texture.read(grid.box(i), texels).ok());
            means.add(grid.box(i), texels);
        }
        Bytes out(desc.box_bytes(box));
        means.finish(out);
        std::size_t at = 0;
        for (std::uint32_t v = box.begin[1]; v < box.end[1]; ++v)
            for (std::uint32_t u = box.begin[0]; u < box.end[0]; ++u)
                for (std::uint32_t t = box.begin[3]; t < box.end[3]; ++t)
                    for (std::uint32_t s = box.begin[2]; s < box.end[2]; ++s)
                        for (int c = 0; c < 3; ++c, at += sample_bytes(type))
                            ASSERT_NEAR(sample_code(load_sample(out.data() + at, type), type),
                                        mean_of(texture, level, {u, v, s, t}, c), 0.5 + 1e-9);
    }
}

TEST(LevelTexels, InterpolationGoesThroughCentresAndKeepsRamps) {
    const TextureDesc desc{{37, 18, 9, 8}, SampleType::half16, 1};
    const LevelEntry full{desc.size, 0, 0, 0}, level = coarse_level(desc.size, 2, 1, 0);
    // A ramp of codes in all four coordinates of level 0, sampled at the centres of 5.4.
    const auto ramp = [](double u, double v, double s, double t) {
        return 1000 + 40 * u + 24 * v + 16 * s - 8 * t;
    };
    TextureDesc coarse = desc;
    coarse.size = level.size;
    Bytes texels(coarse.box_bytes(Box4::whole(level.size)));
    std::size_t at = 0;
    for (std::uint32_t v = 0; v < level.size[1]; ++v)
        for (std::uint32_t u = 0; u < level.size[0]; ++u)
            for (std::uint32_t t = 0; t < level.size[3]; ++t)
                for (std::uint32_t s = 0; s < level.size[2]; ++s, at += 2)
                    store_sample(texels.data() + at,
                                 static_cast<std::uint16_t>(ramp(4 * u + 1.5, 4 * v + 1.5,
                                                                 2 * s + 0.5, 2 * t + 0.5)),
                                 desc.type);
    for (const Box4& box : {Box4::whole(desc.size), Box4{{5, 3, 2, 1}, {29, 17, 7, 8}},
                            Box4{{36, 17, 8, 7}, {37, 18, 9, 8}}}) {
        const Box4 support = support_of(box, full, level);
        ASSERT_TRUE(is_inside(support, level.size));
        Bytes part(coarse.box_bytes(support)), out(desc.box_bytes(box));
        copy_box(support, Box4::whole(level.size), texels, support, part, 2);
        interpolate_level(part, support, box, full, level, desc, out);
        const auto clamped = [](double x, double least, double most) {
            return std::clamp(x, least, most);
        };
        at = 0;
        for (std::uint32_t v = box.begin[1]; v < box.end[1]; ++v)
            for (std::uint32_t u = box.begin[0]; u < box.end[0]; ++u)
                for (std::uint32_t t = box.begin[3]; t < box.end[3]; ++t)
                    for (std::uint32_t s = box.begin[2]; s < box.end[2]; ++s, at += 2)
                        ASSERT_NEAR(load_sample(out.data() + at, desc.type),
                                    ramp(clamped(u, 1.5, 4.0 * (level.size[0] - 1) + 1.5),
                                         clamped(v, 1.5, 4.0 * (level.size[1] - 1) + 1.5),
                                         clamped(s, 0.5, 2.0 * (level.size[2] - 1) + 0.5),
                                         clamped(t, 0.5, 2.0 * (level.size[3] - 1) + 0.5)),
                                    1.0)
                            << u << " " << v << " " << s << " " << t;
    }
}

// ---------------------------------------------------------------- files

struct Layered {
    Bytes file;
    EncodeReport report;
};

// Baked once: that takes longer than to encode it.
MemorySource& baked(const std::string& scene, const Extent4& size) {
    struct Baked {
        Bytes texels;
        std::unique_ptr<MemorySource> source;
    };
    static std::map<std::string, Baked> all;
    Baked& one = all[scene + to_string(size)];
    if (!one.source) {
        const auto scene_source = corpus::make_baked_source(scene, size, 2, 3);
        EXPECT_TRUE(scene_source.ok()) << scene_source.status().message();
        one.texels.resize((*scene_source)->desc().box_bytes(Box4::whole(size)));
        EXPECT_TRUE((*scene_source)->read(Box4::whole(size), one.texels).ok());
        one.source = std::make_unique<MemorySource>((*scene_source)->desc(), one.texels);
    }
    return *one.source;
}

Result<Layered> encode_scene(const char* scene, const Extent4& size, bool layers,
                             EncodeOptions options = {}) {
    MemorySource& source = baked(scene, size);
    options.layers = layers;
    Layered result;
    auto report = encode_memory(source, result.file, options);
    if (!report.ok())
        return report.status();
    result.report = *report;
    return result;
}

EncodeOptions quick(double quality = 60, unsigned threads = 0) {
    EncodeOptions options;
    options.rate = {RateTarget::Kind::quality, quality};
    options.effort = 1;
    options.threads = threads;
    options.tile_extent = {16, 16, 4, 4};
    return options;
}

constexpr Extent4 scene_size{96, 64, 12, 12};

// One file for all tests that only read it.
const Layered& shared_file() {
    static const Layered file = *encode_scene("composed", scene_size, true, quick());
    return file;
}

Bytes texels_of(const Decoder& decoder, const Box4& box, unsigned threads = 1) {
    Bytes texels(decoder.desc().box_bytes(box));
    const Status status = decoder.decode_box(box, texels, threads);
    EXPECT_TRUE(status.ok()) << status.message();
    return texels;
}

double psnr(const Bytes& a, const Bytes& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = std::to_integer<int>(a[i]) - std::to_integer<int>(b[i]);
        sum += d * d;
    }
    return 10 * std::log10(65025.0 * static_cast<double>(a.size()) / std::max(sum, 1e-9));
}

TEST(Layers, CostAtMostThreePerCentAndChangeNoTexel) {
    const auto plain = encode_scene("composed", scene_size, false, quick());
    ASSERT_TRUE(plain.ok());
    const Layered& layered = shared_file();
    ASSERT_EQ(layered.report.coarse_levels.size(), 2u);
    EXPECT_LE(static_cast<double>(layered.file.size()),
              1.03 * static_cast<double>(plain->file.size()));
    const auto a = wrap_memory(plain->file), b = wrap_memory(layered.file);
    const auto da = Decoder::open(*a), db = Decoder::open(*b);
    ASSERT_TRUE(da.ok() && db.ok());
    EXPECT_EQ(texels_of(*da, Box4::whole(scene_size)), texels_of(*db, Box4::whole(scene_size)));
}

TEST(Layers, SameBytesOnAnyNumberOfThreads) {
    const auto one = encode_scene("composed", scene_size, true, quick(60, 1));
    const auto five = encode_scene("composed", scene_size, true, quick(60, 5));
    ASSERT_TRUE(one.ok() && five.ok());
    EXPECT_EQ(one->file, shared_file().file);
    EXPECT_EQ(five->file, shared_file().file);
}

TEST(Layers, TargetsOfSizeCountThem) {
    EncodeOptions options = quick();
    options.rate = {RateTarget::Kind::bytes, 30000};
    const auto file = encode_scene("composed", scene_size, true, options);
    ASSERT_TRUE(file.ok()) << file.status().message();
    EXPECT_LE(file->file.size(), 30000u);
    EXPECT_GE(file->file.size(), 29000u);
    EXPECT_EQ(file->report.file_bytes, file->file.size());
}

TEST(Layers, HalfFloatsOneChannelAndExactFilesHaveThem) {
    const auto lamps = encode_scene("lamps", {64, 32, 8, 8}, true, quick());
    ASSERT_TRUE(lamps.ok()) << lamps.status().message();
    EXPECT_FALSE(lamps->report.coarse_levels.empty());
    EncodeOptions exact = quick();
    exact.rate = {RateTarget::Kind::max_error, 0};
    const auto lossless = encode_scene("gallery", {64, 32, 8, 8}, true, exact);
    ASSERT_TRUE(lossless.ok()) << lossless.status().message();
    EXPECT_FALSE(lossless->report.coarse_levels.empty());
    EXPECT_EQ(lossless->report.max_error, 0);
    for (const Layered* file : {&*lamps, &*lossless}) {
        std::string error;
        EXPECT_TRUE(reference::decode(file->file, error)) << error;
    }
    const TextureDesc grey{{64, 33, 8, 9}, SampleType::unorm8, 1};
    for (const NamedTexture& named : named_textures(grey)) {
        MemoryTexture texture(grey, named.sample);
        Bytes file;
        EncodeOptions options = quick();
        options.layers = true;
        const auto report = encode_memory(texture, file, options);
        ASSERT_TRUE(report.ok()) << named.name << report.status().message();
        std::string error;
        const auto decoded = reference::decode(file, error);
        ASSERT_TRUE(decoded) << named.name << error;
        EXPECT_EQ(decoded->coarse.size(), report->coarse_levels.size());
    }
}

TEST(Layers, BothDecodersAgreeOnEveryLevel) {
    const Layered& layered = shared_file();
    std::string error;
    const auto decoded = reference::decode(layered.file, error);
    ASSERT_TRUE(decoded) << error;
    const auto source = wrap_memory(layered.file);
    const auto decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder.ok());
    EXPECT_EQ(texels_of(*decoder, Box4::whole(scene_size)), decoded->texels);
    // What the library shows of a file that has no tile of level 0 is its level 1, interpolated.
    const ContainerReader& container = decoder->container();
    ASSERT_EQ(container.levels().size(), 3u);
    ASSERT_EQ(decoded->coarse.size(), 2u);
    const std::uint64_t end = container.locate(0)->offset;
    const auto part = wrap_memory(std::span(layered.file).first(end));
    const auto partial = Decoder::open(*part, {true, false});
    ASSERT_TRUE(partial.ok()) << partial.status().message();
    Bytes expected(decoded->texels.size());
    const Level &full = container.levels()[0], &coarse = container.levels()[1];
    const Box4 whole = Box4::whole(scene_size), support = support_of(whole, full, coarse);
    ASSERT_EQ(support, Box4::whole(coarse.size));
    interpolate_level(decoded->coarse[0], support, whole, full, coarse, container.desc(), expected);
    // Tiles of level 0 without bytes are the background, and are there.
    const Bytes shown = texels_of(*partial, whole);
    for (std::uint64_t tile = 0; tile < container.grid().tiles(); ++tile) {
        const Box4 box = container.grid().box(tile);
        const Bytes& from = container.locate(tile)->length == 0 ? decoded->texels : expected;
        Bytes a(container.desc().box_bytes(box)), b(a.size());
        copy_box(box, whole, shown, box, a, 3);
        copy_box(box, whole, from, box, b, 3);
        ASSERT_EQ(a, b) << tile;
    }
}

TEST(Partial, EveryBeginningAfterTheIndexShowsTheTexture) {
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
        // What has been received is exact.
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
    // The levels alone are a picture, not a plain colour.
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

TEST(Partial, BytesThatStopBeforeTheEndOfTheIndexAreRefused) {
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

TEST(DamagedLevels, CoarserLevelsStandInAndEverythingElseDecodes) {
    const Layered& layered = shared_file();
    const auto good_source = wrap_memory(layered.file);
    const auto good = Decoder::open(*good_source);
    ASSERT_TRUE(good.ok());
    const ContainerReader& container = good->container();
    const std::uint64_t begin = container.sections()[container.sections().size() - 2].offset;
    Random random(77);
    for (int round = 0; round < 40; ++round) {
        Bytes file = layered.file;
        // Anywhere in index or data, also in the coarse levels.
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
        // The validator names exactly the tiles that had to be filled, and their texels.
        std::set<std::uint64_t> named;
        for (const Finding& finding : validate_container(*source))
            for (std::uint64_t i = 0; i < finding.tile_count; ++i)
                if (finding.first_tile + i < container.grid().tiles())
                    named.insert(finding.first_tile + i);
        for (std::uint64_t tile = 0; tile < container.grid().tiles(); ++tile) {
            const Box4 box = container.grid().box(tile);
            Bytes part(container.desc().box_bytes(box));
            copy_box(box, Box4::whole(scene_size), shown, box, part, 3);
            // A tile without bytes has no page that could be damaged, but may share a record.
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

TEST(DamagedLevels, FilesWithoutLevelsShowTheBackground) {
    auto plain = encode_scene("composed", {64, 32, 8, 8}, false, quick());
    ASSERT_TRUE(plain.ok());
    plain->file.back() ^= std::byte{1};
    const auto source = wrap_memory(plain->file);
    const auto decoder = Decoder::open(*source, {false, true});
    ASSERT_TRUE(decoder.ok());
    texels_of(*decoder, Box4::whole({64, 32, 8, 8}));
    const FillReport report = decoder->fill_report();
    ASSERT_GT(report.damaged_tiles, 0u);
    const Box4 box = decoder->container().grid().box(report.damaged.front());
    const Bytes texels = texels_of(*decoder, box);
    const auto& background = decoder->container().header().background;
    for (std::size_t i = 0; i < texels.size(); ++i)
        ASSERT_EQ(std::to_integer<int>(texels[i]), background[i % 3]);
}

// ---------------------------------------------------------------- threads

// Also under -fsanitize=thread: tools/test.sh --sanitize thread.
TEST(Threads, AThousandRandomBoxesFromEightThreadsAreThoseOfOne) {
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
            job.box.end[axis] = static_cast<std::uint32_t>(random.range(begin, std::min(n - 1, begin + 20)) + 1);
        }
        job.crc = crc32c(texels_of(*single, job.box));
    }
    std::atomic<std::size_t> next{0};
    std::atomic<int> wrong{0};
    {
        std::vector<std::jthread> threads;
        for (int i = 0; i < 8; ++i)
            threads.emplace_back([&] {
                for (std::size_t j; (j = next++) < jobs.size();) {
                    Bytes texels(shared->desc().box_bytes(jobs[j].box));
                    wrong += !shared->decode_box(jobs[j].box, texels, 1 + j % 2).ok() ||
                             crc32c(texels) != jobs[j].crc;
                }
            });
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(shared->fill_report().damaged_tiles, single->fill_report().damaged_tiles);
    EXPECT_GT(shared->fill_report().damaged_tiles, 0u);
}

// ---------------------------------------------------------------- levels as sources

Bytes layered_file(const Extent4& size, const Extent4& tile) {
    const auto source = corpus::make_baked_source("composed", size, 1, 1);
    EXPECT_TRUE(source.ok());
    EncodeOptions options;
    options.layers = true;
    options.tile_extent = tile;
    options.effort = 1;
    options.rate = {RateTarget::Kind::quality, 90};
    Bytes file;
    EXPECT_TRUE(encode_memory(**source, file, options).ok());
    return file;
}

// In pieces and by few requests, every coarse level is what the second decoder makes of it.
TEST(DecodedLevel, AgreesWithTheSecondDecoder) {
    const Bytes file = layered_file({64, 32, 16, 16}, {16, 16, 8, 8});
    std::string error;
    const auto expected = reference::decode(file, error);
    ASSERT_TRUE(expected) << error;
    const auto memory = wrap_memory(file);
    for (const bool remote : {false, true}) {
        CountingByteSource counted(*memory, remote);
        const auto decoder = Decoder::open(counted);
        ASSERT_TRUE(decoder.ok()) << decoder.status().message();
        const auto levels = decoder->container().levels();
        ASSERT_GE(levels.size(), 2u);
        for (std::size_t level = 0; level < levels.size(); ++level) {
            const auto source = decoded_level(*decoder, level);
            TextureDesc desc = decoder->desc();
            desc.size = levels[level].size;
            ASSERT_EQ(source->desc(), desc);
            const Bytes& whole = level == 0 ? expected->texels : expected->coarse[level - 1];
            counted.reset();
            Bytes texels(desc.box_bytes(Box4::whole(desc.size)));
            ASSERT_TRUE(source->read(Box4::whole(desc.size), texels).ok());
            EXPECT_TRUE(texels == whole) << level;
            if (remote && level > 0) {
                EXPECT_LE(counted.reads().size(), 2u) << "index, and all pages together";
                counted.reset();
            }
            // Any box, from several threads.
            std::vector<std::thread> threads;
            std::atomic<int> wrong{0};
            for (unsigned seed = 0; seed < 4; ++seed)
                threads.emplace_back([&, seed] {
                    Random random(seed);
                    for (int i = 0; i < 20; ++i) {
                        Box4 box;
                        for (std::size_t a = 0; a < 4; ++a) {
                            const int n = static_cast<int>(desc.size[a]);
                            const int begin = random.range(0, n - 1);
                            box.begin[a] = static_cast<std::uint32_t>(begin);
                            box.end[a] = static_cast<std::uint32_t>(random.range(begin + 1, n));
                        }
                        Bytes got(desc.box_bytes(box)), want(got.size());
                        wrong += !source->read(box, got).ok();
                        copy_box(box, Box4::whole(desc.size), whole, box, want,
                                 desc.texel_bytes());
                        wrong += got != want;
                    }
                });
            for (std::thread& thread : threads)
                thread.join();
            EXPECT_EQ(wrong, 0) << level;
            if (remote && level > 0)
                EXPECT_TRUE(counted.reads().empty()) << "its tiles are kept";
        }
    }
}

// What is damaged in a level comes from the next one, or the background, only where that was allowed.
TEST(DecodedLevel, FallsBackAsTheDecoderMay) {
    Bytes file = layered_file({64, 32, 16, 16}, {16, 16, 8, 8});
    std::uint64_t at = 0;
    std::size_t last = 0;
    {
        const auto memory = wrap_memory(file);
        const auto decoder = Decoder::open(*memory);
        ASSERT_TRUE(decoder.ok());
        last = decoder->container().levels().size() - 1;
        const std::uint64_t first = decoder->container().levels()[last].first_tile;
        for (std::uint64_t tile = first; at == 0; ++tile)
            if (const auto place = decoder->container().locate(tile); place->length > 0)
                at = place->offset;
    }
    file[at] ^= std::byte{1};
    const auto memory = wrap_memory(file);
    for (const bool allowed : {false, true}) {
        DecodeOptions options;
        options.allow_damaged = allowed;
        const auto decoder = Decoder::open(*memory, options);
        ASSERT_TRUE(decoder.ok());
        const auto source = decoded_level(*decoder, last);
        Bytes texels(source->desc().box_bytes(Box4::whole(source->desc().size)));
        const Status status = source->read(Box4::whole(source->desc().size), texels);
        EXPECT_EQ(status.ok(), allowed) << status.message();
        if (!allowed)
            EXPECT_EQ(status.code(), ErrorCode::invalid_file);
        EXPECT_EQ(decoder->fill_report().texels, 0u) << "of level 0 only";
        Bytes few(3);
        const Box4 outside{source->desc().size, {9999, 9999, 9999, 9999}};
        EXPECT_EQ(source->read(outside, few).code(), ErrorCode::bad_argument);
        EXPECT_EQ(decoder->decode_coarse_box(0, {{0, 0, 0, 0}, {1, 1, 1, 1}}, few).code(),
                  ErrorCode::bad_argument);
        EXPECT_EQ(decoder->decode_coarse_box(9, {{0, 0, 0, 0}, {1, 1, 1, 1}}, few).code(),
                  ErrorCode::bad_argument);
    }
}

} // namespace
} // namespace tessera
