// Views with a common parallax are aligned. Decoding gives the texture without the alignment.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/tessera.h"
#include "format/io/bytes.h"
#include "format/texture.h"
#include "tests/support/efforts.h"
#include "tests/support/encoded_file.h"
#include "tests/support/forged_alignment.h"
#include "tests/support/moving_views.h"
#include "tests/support/random_box.h"
#include "tests/support/rewritten_file.h"
#include "tests/support/tool_words.h"

#include <atomic>
#include <gtest/gtest.h>
#include <mutex>
#include <thread>

namespace tessera::test {
namespace {

using Kind = RateTarget::Kind;

constexpr Extent4 views_size{48, 40, 4, 3};
const TextureDesc views_colour{views_size, SampleType::unorm8, 3};

SwitchedOptions views_options(RateTarget rate = {Kind::quality, 60}) {
    SwitchedOptions options;
    options.rate = rate;
    options.effort = copies_effort;
    options.threads = 2;
    options.tile_extent = {16, 16, 4, 3};
    return options;
}

struct OpenViews {
    explicit OpenViews(const Bytes& file)
        : bytes(wrap_memory(file)), decoder(std::move(*Decoder::open(*bytes))) {}
    std::unique_ptr<ByteSource> bytes;
    Decoder decoder;
};

ViewAlignment alignment_of(TexelSource& source, const SwitchedOptions& options) {
    Bytes file;
    const auto report = encode_memory(source, file, options);
    EXPECT_TRUE(report) << report.status().message();
    return OpenViews(file).decoder.container().alignment();
}

// A file whose header declares an alignment of -3 and 5 texels, which the encoder did not choose.
Bytes forged_file(int u, int v) {
    MemoryTexture texture = moving_views(views_colour, u, v);
    EncodeOptions options = views_options();
    options.effort = 0;
    return with_alignment(encode_file_of(texture, options).file, {-3, 5});
}

TEST(Alignment, IsTheOppositeOfTheParallax) {
    for (const auto& [u, v] : {std::pair(2, 2), std::pair(-3, 3), std::pair(1, -1)}) {
        MemoryTexture texture = moving_views(views_colour, u, v);
        EXPECT_EQ(alignment_of(texture, views_options()),
                  (ViewAlignment{static_cast<std::int8_t>(-u), static_cast<std::int8_t>(-v)}));
    }
    MemoryTexture green(views_colour, [](int x, int y, int s, int t, int c) {
        return c == 1 ? moving_picture(x - 2 * s, y + 2 * t, c) : 0.5;
    });
    EXPECT_EQ(alignment_of(green, views_options()), (ViewAlignment{-2, 2}));
    MemoryTexture halves = moving_views({views_size, SampleType::half16, 1}, 2, 2);
    EXPECT_EQ(alignment_of(halves, views_options()), (ViewAlignment{-2, -2}));
    MemoryTexture still = moving_views(views_colour, 0, 0);
    EXPECT_EQ(alignment_of(still, views_options()), ViewAlignment{});
}

// Motion along the swapped axes shows that s and t are exchanged.
TEST(Alignment, DetectsTransposedViews) {
    const auto looks_transposed = [](MemoryTexture texture, const EncodeOptions& options) {
        Bytes file;
        const auto report = encode_memory(texture, file, options);
        EXPECT_TRUE(report) << report.status().message();
        return report && report->looks_transposed;
    };
    const auto swapped = [](int u, int v) {
        return MemoryTexture(views_colour, [=](int x, int y, int s, int t, int c) {
            return moving_picture(x - u * t, y - v * s, c);
        });
    };
    EXPECT_TRUE(looks_transposed(swapped(2, 2), views_options()));
    EXPECT_TRUE(looks_transposed(swapped(1, -3), views_options()));
    EXPECT_FALSE(looks_transposed(moving_views(views_colour, 2, 2), views_options()));
    EXPECT_FALSE(looks_transposed(moving_views(views_colour, 0, 0), views_options()));
    EncodeOptions sphere = views_options();
    sphere.description.proxy = Proxy::sphere;
    sphere.description.sphere_radius = 1;
    EXPECT_FALSE(looks_transposed(swapped(2, 2), sphere)) << "directions are not cameras";
}

TEST(Alignment, IsOffForLayersAndSpheres) {
    MemoryTexture texture = moving_views(views_colour, 2, 2);
    SwitchedOptions options = views_options();
    options.layers = true;
    EXPECT_EQ(alignment_of(texture, options), ViewAlignment{});
    options = views_options();
    options.tools = "-align";
    EXPECT_EQ(alignment_of(texture, options), ViewAlignment{});
    options = views_options();
    options.description.proxy = Proxy::sphere;
    options.description.sphere_radius = 1;
    EXPECT_EQ(alignment_of(texture, options), ViewAlignment{});
    options = views_options();
    options.description.surface_map = SurfaceMap::mesh_uv;
    options.description.angular_map = AngularMap::octahedral_mirrored;
    EXPECT_EQ(alignment_of(texture, options), ViewAlignment{}) << "a layer on a mesh";
}

// The error is the reported one. Boxes and streamed slabs give the same texels as a whole decode.
TEST(Alignment, DecodesToTheTexture) {
    MemoryTexture texture = moving_views(views_colour, -2, 2);
    const Box4 whole = Box4::whole(views_size);
    for (const RateTarget& rate : {RateTarget{Kind::quality, 70}, RateTarget{Kind::max_error, 0}}) {
        const EncodedFile encoded = encode_file_of(texture, views_options(rate));
        const OpenViews open(encoded.file);
        ASSERT_TRUE(open.decoder.container().alignment().any());
        EXPECT_EQ(open.decoder.desc(), views_colour);
        EXPECT_EQ(open.decoder.container().grid().size(), (Extent4{54, 44, 4, 3}));
        Bytes texels(texture.texels.size());
        ASSERT_TRUE(open.decoder.decode_box(whole, texels, {.threads = 2}));
        double squares = 0;
        for (std::size_t i = 0; i < texels.size(); ++i) {
            const int d = std::to_integer<int>(texels[i]) - std::to_integer<int>(texture.texels[i]);
            squares += d * d;
        }
        EXPECT_EQ(encoded.report.raw_bytes, texels.size());
        EXPECT_FALSE(encoded.report.texels_that_matter);
        EXPECT_NEAR(encoded.report.bits_per_texel,
                    8.0 * static_cast<double>(encoded.file.size()) /
                        static_cast<double>(texel_count(views_size)),
                    1e-9);
        if (rate.kind == Kind::max_error) {
            EXPECT_EQ(squares, 0);
            EXPECT_EQ(encoded.report.psnr, 999);
        } else {
            EXPECT_NEAR(encoded.report.psnr,
                        10 * std::log10(255 * 255 * static_cast<double>(texels.size()) / squares),
                        1e-6);
        }
        Random random(4);
        for (int i = 0; i < 20; ++i) {
            const Box4 box = random_box(random, views_size);
            Bytes part(views_colour.box_bytes(box)), expected(part.size());
            ASSERT_TRUE(open.decoder.decode_box(box, part, {.threads = 1}));
            copy_box(box, whole, texels, box, expected, 3);
            EXPECT_EQ(part, expected) << to_string(box);
        }
    }
}

// A decoded source keeps decoded tiles. It is read in random boxes by several threads, through a
// slow byte source, and from a file that is cut off.
TEST(Alignment, SourcesReturnTheDecodedTexels) {
    Random noise(1); // so that the file is longer than the first read
    MemoryTexture texture(views_colour,
                          [&](int, int, int, int, int) { return noise.range(0, 255) / 255.0; });
    EncodeOptions options = views_options({Kind::max_error, 0});
    options.effort = 0;
    Bytes file = with_alignment(encode_file_of(texture, options).file, {-3, 5});
    const OpenViews open(file);
    const TextureDesc& desc = open.decoder.desc();
    const auto source = decoded_source(open.decoder);
    ASSERT_EQ(source->desc(), desc);
    const Box4 whole = Box4::whole(desc.size);
    Bytes texels(desc.box_bytes(whole));
    ASSERT_TRUE(open.decoder.decode_box(whole, texels));
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (unsigned seed = 0; seed < 3; ++seed)
        threads.emplace_back([&, seed] {
            Random random(seed);
            for (int i = 0; i < 20; ++i) {
                const Box4 box = random_box(random, desc.size);
                Bytes part(desc.box_bytes(box)), expected(part.size());
                wrong += !source->read(box, part).ok();
                copy_box(box, whole, texels, box, expected, 3);
                wrong += part != expected;
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(wrong, 0);
    Bytes three(3);
    EXPECT_EQ(source->read({{39, 0, 0, 0}, {40, 1, 1, 1}}, three).code(), ErrorCode::bad_argument);
    EXPECT_EQ(source->read({{0, 0, 0, 0}, {1, 1, 1, 2}}, three).code(), ErrorCode::bad_argument);

    // A slow byte source is read ahead, in few requests.
    CountingByteSource counted(*open.bytes, true);
    const Result<Decoder> far = Decoder::open(counted);
    ASSERT_TRUE(far) << far.status().message();
    const auto ahead = decoded_source(*far);
    counted.reset();
    ASSERT_TRUE(ahead->begin_slab(whole));
    Bytes place(3);
    for (std::uint32_t v = 0; v < desc.size[axis_v]; v += 3)
        for (std::uint32_t u = 0; u < desc.size[axis_u]; u += 3) {
            const Box4 box{{u, v, 0, 0}, {u + 1, v + 1, 1, 1}};
            ASSERT_TRUE(ahead->read(box, place));
            Bytes expected(3);
            copy_box(box, whole, texels, box, expected, 3);
            EXPECT_EQ(place, expected) << to_string(box);
        }
    EXPECT_LE(counted.reads().size(), 4u); // reading tile by tile takes eight

    file.resize(static_cast<std::size_t>(open.decoder.container().sections().back().offset));
    const auto cut = wrap_memory(file);
    const Result<Decoder> decoder = Decoder::open(*cut, DecodeOptions{.allow_partial = true});
    ASSERT_TRUE(decoder) << decoder.status().message();
    const auto filled = decoded_source(*decoder);
    for (int twice = 0; twice < 2; ++twice)
        ASSERT_TRUE(filled->read(whole, texels));
    EXPECT_EQ(decoder->fill_report().texels, texel_count(desc.size));
}

// Collects texels. Its locality decides the shape of the slabs.
class SlabCollector : public TexelSink {
public:
    SlabCollector(const TextureDesc& desc, Locality locality)
        : texels(desc.box_bytes(Box4::whole(desc.size))), desc_(desc), locality_(locality) {}
    Locality locality() const override { return locality_; }
    Status begin_slab(const Box4&) override {
        ++slabs;
        return {};
    }
    Status write(const Box4& box, std::span<const std::byte> part) override {
        const std::lock_guard lock(mutex_);
        copy_box(box, box, part, Box4::whole(desc_.size), texels, desc_.texel_bytes());
        return {};
    }
    Bytes texels;
    int slabs = 0;

private:
    TextureDesc desc_;
    Locality locality_;
    std::mutex mutex_;
};

TEST(Alignment, StreamsInSlabsOfEveryKind) {
    MemoryTexture texture = moving_views(views_colour, 2, -2);
    const EncodedFile encoded = encode_file_of(texture, views_options());
    const OpenViews open(encoded.file);
    Bytes texels(texture.texels.size());
    ASSERT_TRUE(open.decoder.decode_box(Box4::whole(views_size), texels));
    for (const Locality locality :
         {Locality::any, Locality::spatial_rows, Locality::angular_cells, Locality::places}) {
        SlabCollector sink(views_colour, locality);
        const std::uint64_t slab = 2 * texels.size() / 5; // half of the budget holds the slab
        const Status status = open.decoder.decode(Box4::whole(views_size), sink, 2, {}, slab);
        ASSERT_TRUE(status) << status.message();
        EXPECT_EQ(sink.texels, texels);
        EXPECT_GE(sink.slabs, 3);
    }
}

// The decoder fills views from empty tiles without decoding them. The texels are the same as in the
// grid, where a background of -0 becomes +0.
TEST(Alignment, EmptyTilesAreTheBackground) {
    const TextureDesc colour{views_size, SampleType::half16, 3};
    MemoryTexture texture = moving_views(colour, 0, 0);
    EncodeOptions options = views_options();
    options.effort = 0;
    options.tile_extent = {16, 16, 2, 2};
    const Bytes whole_file = encode_file_of(texture, options).file;
    const Bytes half_empty =
        rewritten(whole_file, [](ContainerContents& contents, std::vector<Bytes>& tiles) {
            contents.background = {0x8000, 0x3C00, 0x1234};
            for (std::size_t i = 1; i < tiles.size(); i += 2)
                tiles[i].clear();
        });
    const Bytes file = with_alignment(half_empty, {-3, 5});
    const OpenViews open(file);
    const TextureDesc& desc = open.decoder.desc();
    const Box4 in_grid = Box4::whole(views_size), whole = Box4::whole(desc.size);
    Bytes grid(colour.box_bytes(in_grid)), expected(desc.box_bytes(whole)), texels(expected.size());
    ASSERT_TRUE(open.decoder.decode_grid_box(in_grid, grid, {}));
    EXPECT_EQ(load_le<std::uint16_t>(grid.data() + 6 * 12 * 20), 0); // of tile 1, (20, 0, 0, 0)
    open.decoder.container().aligned_views().copy_from_grid(in_grid, grid, whole, expected, 6);
    ASSERT_TRUE(open.decoder.decode_box(whole, texels));
    EXPECT_EQ(texels, expected);
    texels.assign(texels.size(), std::byte{1});
    ASSERT_TRUE(decoded_source(open.decoder)->read(whole, texels));
    EXPECT_EQ(texels, expected);
    const Box4 last{{0, 0, 2, 0}, {desc.size[0], desc.size[1], 4, 2}}; // one tile along s, t
    Bytes part(desc.box_bytes(last)), expected_part(part.size());
    ASSERT_TRUE(decoded_source(open.decoder)->read(last, part));
    copy_box(last, whole, texels, last, expected_part, 6);
    EXPECT_EQ(part, expected_part);
    SlabCollector sink(desc, Locality::any);
    ASSERT_TRUE(open.decoder.decode(whole, sink));
    EXPECT_EQ(sink.texels, expected);
}

TEST(Alignment, SavesBytes) {
    MemoryTexture texture = moving_views(views_colour, 2, 2);
    SwitchedOptions options = views_options();
    const EncodedFile aligned = encode_file_of(texture, options);
    options.tools = "-align";
    const EncodedFile plain = encode_file_of(texture, options);
    EXPECT_LT(aligned.file.size(), 0.7 * static_cast<double>(plain.file.size()));
    EXPECT_GT(aligned.report.psnr, plain.report.psnr - 0.5);
}

// Aligning pictures needs all of them in memory. They are aligned only if slab_bytes allows it, and
// then the file is the same as that of a texture in memory.
TEST(Alignment, NeedsMemoryForAllPictures) {
    struct Pictures : MemoryTexture {
        using MemoryTexture::MemoryTexture;
        Locality locality() const override { return Locality::angular_cells; }
    };
    Pictures pictures(views_colour, [](int x, int y, int s, int t, int c) {
        return moving_picture(x - 2 * s, y - 2 * t, c);
    });
    MemoryTexture texture = moving_views(views_colour, 2, 2);
    EncodeOptions options = views_options();
    options.slab_bytes = 2 * texture.texels.size();
    EXPECT_EQ(encode_file_of(pictures, options).file, encode_file_of(texture, options).file);
    --options.slab_bytes;
    EXPECT_EQ(alignment_of(pictures, options), ViewAlignment{});
    EXPECT_TRUE(alignment_of(texture, options).any());

    // Reusing an aligned file requires the alignment, so too small a budget is an error.
    options.slab_bytes = texture.texels.size();
    const OpenViews open(encode_file_of(texture, options).file);
    options.tile_extent = tile_by_trial;
    options.reuse = &open.decoder;
    EXPECT_TRUE(encode_memory(pictures, pictures.texels, options).ok());
    --options.slab_bytes;
    EXPECT_EQ(encode_memory(pictures, pictures.texels, options).status().code(),
              ErrorCode::over_budget);
}

TEST(Alignment, SizeTargetsCountTexelsOfTheTexture) {
    MemoryTexture texture = moving_views(views_colour, 3, 3);
    const EncodedFile encoded = encode_file_of(texture, views_options({Kind::bpt, 0.8}));
    EXPECT_LE(encoded.report.bits_per_texel, 0.8);
    EXPECT_GT(encoded.report.bits_per_texel, 0.7);
}

TEST(Alignment, ThreadsDoNotMatter) {
    MemoryTexture texture = moving_views(views_colour, 2, 2);
    EncodeOptions options = views_options();
    const EncodedFile two = encode_file_of(texture, options);
    options.threads = 1;
    EXPECT_EQ(encode_file_of(texture, options).file, two.file);
}

// Reusing a file keeps its alignment and its tiles, also under a mask.
TEST(Alignment, ReuseKeepsTheAlignment) {
    MemoryTexture texture = moving_views(views_colour, 2, 2);
    const EncodedFile encoded = encode_file_of(texture, views_options());
    const OpenViews open(encoded.file);
    MemoryTexture decoded = texture;
    ASSERT_TRUE(open.decoder.decode_box(Box4::whole(views_size), decoded.texels));
    EncodeOptions options = views_options();
    options.tile_extent = tile_by_trial;
    options.reuse = &open.decoder;
    const EncodedFile again = encode_file_of(decoded, options);
    EXPECT_EQ(again.report.kept_tiles, open.decoder.container().tile_count());
    EXPECT_EQ(OpenViews(again.file).decoder.container().alignment(),
              open.decoder.container().alignment());
    // The masked half of the texture changes.
    MemoryTexture mask({{48, 1, 1, 1}, SampleType::unorm8, 1},
                       [](int u, int, int, int, int) { return u < 24 ? 1.0 : 0.0; });
    const std::size_t row = decoded.texels.size() / 40;
    for (std::size_t i = 0; i < decoded.texels.size(); ++i)
        if (i % row >= row / 2)
            decoded.texels[i] = std::byte{77};
    options.mask = &mask;
    const EncodedFile masked = encode_file_of(decoded, options);
    EXPECT_EQ(masked.report.kept_tiles, open.decoder.container().tile_count());
    EXPECT_EQ(masked.report.texels_that_matter, texel_count(views_size) / 2);
    options.mask = nullptr;
    options.layers = true;
    EXPECT_EQ(encode_memory(decoded, decoded.texels, options).status().code(),
              ErrorCode::bad_argument);
}

// The fill report counts texels of the texture. Findings give positions in the grid and say so.
TEST(Alignment, FilledTexelsAreCountedInTheTexture) {
    Bytes file = forged_file(0, 0);
    const auto last = file.end() - 1;
    *last ^= std::byte{1};
    const auto damaged = wrap_memory(file);
    const std::vector<Finding> findings = validate_container(*damaged);
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_NE(findings[0].text.find("of the grid of aligned views"), std::string::npos);
    *last ^= std::byte{1};
    const auto sound = wrap_memory(file);
    const Result<ContainerReader> reader = ContainerReader::open(*sound);
    ASSERT_TRUE(reader) << reader.status().message();
    const Extent4 size = reader->desc().size;
    EXPECT_EQ(size, (Extent4{39, 30, 4, 3}));
    file.resize(static_cast<std::size_t>(reader->sections().back().offset)); // the offset of DATA
    const auto cut = wrap_memory(file);
    const Result<Decoder> decoder = Decoder::open(*cut, DecodeOptions{.allow_partial = true});
    ASSERT_TRUE(decoder) << decoder.status().message();
    Bytes texels(decoder->desc().box_bytes(Box4::whole(size)));
    ASSERT_TRUE(decoder->decode_box(Box4::whole(size), texels, {.threads = 1}));
    EXPECT_EQ(decoder->fill_report().texels, texel_count(size));
}

// In the C interface level 0 has the size of the grid. The texture and its boxes have their own
// size.
TEST(Alignment, LevelZeroOfTheCInterfaceIsTheGrid) {
    const Bytes file = forged_file(0, 0);
    tessera_decoder* decoder = nullptr;
    ASSERT_EQ(tessera_open_memory(file.data(), file.size(), nullptr, &decoder), TESSERA_OK);
    tessera_texture texture;
    ASSERT_EQ(tessera_get_texture(decoder, &texture), TESSERA_OK);
    EXPECT_EQ(std::vector(texture.size, texture.size + 4), (std::vector<uint32_t>{39, 30, 4, 3}));
    tessera_level level;
    tessera_level_init(&level);
    ASSERT_EQ(tessera_get_level(decoder, 0, &level), TESSERA_OK);
    EXPECT_EQ(std::vector(level.size, level.size + 4), (std::vector<uint32_t>{48, 40, 4, 3}));
    const uint32_t begin[4] = {38, 29, 3, 2}, end[4] = {39, 30, 4, 3}, beyond[4] = {40, 30, 4, 3};
    std::uint8_t texel[6];
    EXPECT_EQ(tessera_decode_box(decoder, begin, end, texel, 3, nullptr), TESSERA_OK);
    EXPECT_EQ(tessera_decode_box(decoder, begin, beyond, texel, 6, nullptr), TESSERA_BAD_ARGUMENT);
    tessera_close(decoder);
}

// Error messages name a texel by its position in the texture, not in the grid.
TEST(Alignment, MessagesNameTexelsOfTheTexture) {
    const TextureDesc desc{views_size, SampleType::half16, 1};
    MemoryTexture texture = moving_views(desc, 2, 2);
    const std::size_t at = ((std::size_t{7} * 48 + 30) * 3 + 2) * 4 + 1;
    texture.texels[2 * at + 1] = std::byte{0x7E};
    EncodeOptions options = views_options();
    options.strict = true;
    Bytes file;
    const Status status = encode_memory(texture, file, options).status();
    EXPECT_EQ(status.code(), ErrorCode::invalid_file);
    EXPECT_NE(status.message().find("texel u 30, v 7, s 1, t 2, channel 0 is NaN"),
              std::string::npos)
        << status.message();
}

} // namespace
} // namespace tessera::test
