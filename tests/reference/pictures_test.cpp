// Compares the library with the second decoder on pictures: tiles of one view, and tiles with base
// pictures. Some files are encoded, others are written symbol by symbol.
#include "codec/entropy/tile_syntax.h"
#include "corpus/bake.h"
#include "format/tile/features.h"
#include "tests/reference/agreement.h"
#include "tests/support/decode_cases.h"
#include "tests/support/rewritten_file.h"

#include <set>
#include <string>
#include <vector>

namespace tessera {
namespace {

using namespace test;

CodingParameters parameters_of(const Bytes& file) {
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    EXPECT_TRUE(reader) << reader.status().message();
    const auto parameters =
        read_coding_parameters(reader->codec_parameters(), reader->header().desc.channels, false);
    EXPECT_TRUE(parameters) << parameters.status().message();
    return *parameters;
}

TEST(Pictures, OfEveryKindAndEffort) {
    for (int effort = copies_effort; effort <= 4; ++effort)
        for (const SampleType type : {SampleType::unorm8, SampleType::half16})
            for (const int channels : {1, 3, 4})
                for (const int quality : {30, 80}) {
                    CodeTexture texture = make_texture("waves", {37, 53, 1, 1}, channels, type);
                    const Bytes file = encode(texture, {Kind::quality, double(quality)},
                                              {64, 64, 1, 1}, {}, effort);
                    EXPECT_TRUE(parameters_of(file).prediction); // modes are worth it
                    expect_decodes(file, "effort " + std::to_string(effort) + ", quality " +
                                             std::to_string(quality) + ", channels " +
                                             std::to_string(channels));
                }
}

TEST(Pictures, InTilesWithSidesAbove64) {
    int effort = copies_effort;
    for (const auto& [size, extent] : {std::pair{Extent4{256, 100, 1, 1}, Extent4{256, 256, 1, 1}},
                                       {{100, 256, 1, 1}, {256, 256, 1, 1}},
                                       {{256, 256, 1, 1}, {256, 256, 1, 1}},
                                       {{300, 70, 2, 1}, {150, 70, 1, 1}},
                                       {{65, 129, 2, 2}, {65, 129, 2, 2}}})
        for (const char* name : {"coloured", "sparse"}) {
            CodeTexture texture = make_texture(name, size, 3, SampleType::unorm8);
            expect_decodes(encode(texture, {Kind::quality, 50}, extent, {}, effort),
                           name + (" " + to_string(size)) + " effort " + std::to_string(effort));
            effort = effort == 4 ? copies_effort : effort + 1;
        }
}

TEST(Pictures, Lossless) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        CodeTexture texture = make_texture("waves", {37, 53, 1, 1}, 3, type);
        expect_decodes(encode(texture, {Kind::max_error, 0}, {64, 64, 1, 1}, {}, copies_effort),
                       "lossless");
    }
}

TEST(Pictures, OfScenes) {
    for (const char* scene : {"composed", "gallery", "lamps"}) {
        auto source = corpus::make_baked_source(scene, {90, 70, 1, 1}, 2, 1);
        ASSERT_TRUE(source) << source.status().message();
        for (const int quality : {25, 60, 95})
            expect_decodes(
                encode(**source, {Kind::quality, double(quality)}, {90, 70, 1, 1}, {}, 3), scene);
    }
}

TEST(Pictures, WhoseChannelsHaveTreesOfTheirOwn) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        CodeTexture unlike(
            {{90, 50, 1, 1}, type, 2}, [](double u, double v, double, double, int c) {
                const double x = 90 * u, y = 50 * v;
                return 0.5 + (std::fmod(c == 0 ? 2 * x + y : 3 * y - x + 90, 25.0) < 9 ? 0.2 : 0.0);
            });
        const Bytes file = encode(unlike, {Kind::quality, 60}, {64, 64, 1, 1}, {}, usual_effort);
        EXPECT_TRUE(parameters_of(file).plane_trees);
        expect_decodes(file, "a tree for each channel");
        const Bytes one = encode(unlike, {Kind::quality, 60}, {64, 64, 1, 1}, {}, copies_effort);
        EXPECT_FALSE(parameters_of(one).plane_trees);
    }
}

// A picture that moves by 0.75 texels per view, so that copies of a base picture need its eighths.
TEST(Pictures, BasePicturesOfCameraGrids) {
    for (const auto& [effort, type, channels] : {std::tuple{3, SampleType::unorm8, 1},
                                                 {3, SampleType::unorm8, 4},
                                                 {3, SampleType::half16, 3},
                                                 {4, SampleType::unorm8, 3}}) {
        CodeTexture views({{33, 28, 3, 3}, type, static_cast<std::uint8_t>(channels)},
                          [](double u, double v, double s, double t, int c) {
                              const double x = 33 * u + 2.25 * s, y = 28 * v - 2.25 * t;
                              return 0.5 + 0.2 * std::sin(x * 1.7 + c) * std::cos(y * 1.3) +
                                     0.15 * std::sin(x * 0.9 + y * 2.1 + 2 * c);
                          });
        const Bytes file = encode(views, {Kind::quality, 55}, {33, 28, 3, 3}, {}, effort);
        EXPECT_TRUE(parameters_of(file).base.on) << effort << ", channels " << channels;
        expect_decodes(file, "camera grid, channels " + std::to_string(channels));
    }
}

// Writes the stream of a tile symbol by symbol.
class HandMadeTile {
public:
    HandMadeTile(const CodingParameters& parameters, const TextureDesc& desc)
        : parameters_(parameters), desc_(desc),
          tables_(parameters.parameters, parameters.leaves_out_transforms) {}

    HandMadeTile& split(int kind, int a = 0, int b = 0) {
        tables_.split[depth_class(a)][depth_class(b)].encode(coder_, kind);
        return *this;
    }
    HandMadeTile& mode(int context, int symbol) {
        tables_.mode[static_cast<std::size_t>(context)].encode(coder_, symbol);
        return *this;
    }
    HandMadeTile& raw(std::uint32_t value, int bits) {
        coder_.raw(value, bits);
        return *this;
    }
    // The length 1 of plane 0 of a block with that many texels.
    HandMadeTile& one_coefficient(int texels) {
        first_length(texels, 1);
        return *this;
    }
    HandMadeTile& colour(int context, int symbol) {
        tables_.colour[static_cast<std::size_t>(context)].encode(coder_, symbol);
        return *this;
    }
    HandMadeTile& share(int plane, int difference) {
        const int token = difference_token(difference);
        tables_.share[static_cast<std::size_t>(plane)].encode(coder_, token);
        if (token > 0) {
            coder_.raw(static_cast<std::uint32_t>(std::abs(difference)) - (1u << (token - 1)),
                       token - 1);
            coder_.raw(difference < 0, 1);
        }
        return *this;
    }
    HandMadeTile& transform(int context, int symbol) {
        tables_.transform[static_cast<std::size_t>(context)].encode(coder_, symbol);
        return *this;
    }
    // The coefficient `magnitude` (1..4) of a block with one coefficient, and empty other planes.
    HandMadeTile& coefficient(int texels, int magnitude) {
        first_coefficient(texels, 0, magnitude);
        for (int plane = 1; plane < desc_.channels; ++plane)
            tables_.other_length[1].encode(coder_, 0);
        return *this;
    }
    // The length 1 of plane 1 behind an empty plane 0, and the coefficient that follows it.
    HandMadeTile& second_plane(int texels) {
        first_length(texels, 0);
        tables_.other_length[0].encode(coder_, 1);
        return *this;
    }
    HandMadeTile& second_coefficient(int texels, int magnitude) {
        first_coefficient(texels, 1, magnitude);
        return *this;
    }
    // The only plane of a block, with one coefficient.
    HandMadeTile& only_coefficient(int texels, int magnitude) {
        first_coefficient(texels, 0, magnitude);
        return *this;
    }
    // A block without coefficients.
    HandMadeTile& empty_block(int texels) {
        first_length(texels, 0);
        for (int plane = 1; plane < desc_.channels; ++plane)
            tables_.other_length[0].encode(coder_, 0);
        return *this;
    }

    // Both decoders must agree on the file. Returns whether they accept it.
    bool is_accepted(const std::string& what) { return outcome(what).accepted; }
    Outcome outcome(const std::string& what) {
        Bytes payload;
        coder_.finish(payload);
        return expect_agreement(file_with(parameters_, desc_, payload), what);
    }

    static Bytes file_with(const CodingParameters& parameters, const TextureDesc& desc,
                           const Bytes& payload) {
        const auto section = write_coding_parameters(parameters, desc.channels, false);
        ContainerContents contents;
        contents.desc = desc;
        contents.tile_extent = desc.size;
        contents.colour = desc.channels >= 3 ? ColourTransform::ycocg_r : ColourTransform::none;
        for (std::size_t i = 0; i < desc.channels; ++i)
            contents.background[i] = 100;
        contents.required_features = features_of(parameters);
        contents.codec_parameters = section;
        contents.tile = [&](std::uint64_t) { return std::span<const std::byte>(payload); };
        Bytes file;
        VectorSink sink(file);
        const auto written = write_container(contents, sink);
        EXPECT_TRUE(written) << written.status().message();
        return file;
    }

private:
    // The length token of plane 0 of a block with that many texels.
    void first_length(int texels, int token) {
        const int context = length_context(shape_of(texels, 1, 1, 1), false);
        tables_.first_length[static_cast<std::size_t>(context)].encode(coder_, token);
    }

    void first_coefficient(int texels, int plane, int magnitude) {
        const int size = size_class(shape_of(texels, 1, 1, 1));
        coder_.bit(
            true,
            tables_.zero[static_cast<std::size_t>(zero_parameter(false, 0, plane, 0, size, 0))]);
        tables_.magnitude[static_cast<std::size_t>(magnitude_table(false, 0, plane, true, size, 0))]
            .encode(coder_, magnitude - 1);
        coder_.raw(0, 1);
    }

    const CodingParameters& parameters_;
    const TextureDesc desc_;
    const CodeTables tables_;
    RansEncoder coder_;
};

CodingParameters coloured_parameters() {
    CodingParameters parameters;
    parameters.colour_rotation = true;
    for (StepCode& step : parameters.step)
        step.bits = 4 << 11;
    parameters.rotated_step.bits = 4 << 11;
    return parameters;
}

TEST(ForgedPictures, Rotations) {
    const CodingParameters parameters = coloured_parameters();
    const TextureDesc desc{{4, 4, 1, 1}, SampleType::unorm8, 3};
    const auto rotation = [&](std::uint32_t index) {
        HandMadeTile tile(parameters, desc);
        tile.split(0).one_coefficient(16).colour(0, 2).raw(index, 6).coefficient(16, 3);
        return tile.outcome("rotation " + std::to_string(index));
    };
    for (const std::uint32_t index : {0u, 1u, 48u})
        EXPECT_TRUE(rotation(index).accepted);
    for (const std::uint32_t index : {49u, 50u, 63u})
        EXPECT_FALSE(rotation(index).accepted);

    HandMadeTile repeated(parameters, desc); // a repetition of nothing is rotation 0
    repeated.split(0).one_coefficient(16).colour(0, 1).coefficient(16, 3);
    EXPECT_EQ(repeated.outcome("repeated").texels, rotation(0).texels);
    EXPECT_NE(rotation(1).texels, rotation(0).texels);
}

TEST(ForgedPictures, Shares) {
    const CodingParameters parameters = coloured_parameters();
    const TextureDesc desc{{4, 4, 1, 1}, SampleType::unorm8, 3};
    const auto shares = [&](int a, int b) {
        HandMadeTile tile(parameters, desc);
        tile.split(0).one_coefficient(16).colour(0, 3).share(0, a);
        if (std::abs(a) <= 64)
            tile.share(1, b).coefficient(16, 3);
        return tile.is_accepted(std::to_string(a) + ", " + std::to_string(b));
    };
    for (const auto& [a, b] : {std::pair{64, -64}, {-64, 64}, {0, 1}, {-1, 0}, {64, 64}})
        EXPECT_TRUE(shares(a, b)) << a << ", " << b;
    for (const auto& [a, b] :
         {std::pair{0, 0}, {65, 1}, {-65, 1}, {1, 65}, {1, -65}, {0, 255}, {-255, 0}})
        EXPECT_FALSE(shares(a, b)) << a << ", " << b;
}

TEST(ForgedPictures, SharesFollowThoseOfEarlierBlocks) {
    const CodingParameters parameters = coloured_parameters();
    const TextureDesc desc{{12, 4, 1, 1}, SampleType::unorm8, 3};
    // Blocks of 3, 3 and 6 texels along u. The first has the shares 64, -64.
    const auto start = [&](HandMadeTile& tile) -> HandMadeTile& {
        return tile.split(3)
            .split(3, 1)
            .split(0, 2)
            .split(0, 2)
            .split(0, 1)
            .one_coefficient(12)
            .colour(0, 3)
            .share(0, 64)
            .share(1, -64)
            .coefficient(12, 2);
    };
    const auto with = [&](int a, int b, bool rotated_between) {
        HandMadeTile tile(parameters, desc);
        start(tile);
        if (rotated_between) // does not change the shares
            tile.one_coefficient(12).colour(2, 2).raw(7, 6).coefficient(12, 1);
        else
            tile.empty_block(12);
        tile.one_coefficient(24).colour(rotated_between ? 1 : 2, 3).share(0, a);
        if (64 + a <= 64)
            tile.share(1, b).coefficient(24, 2);
        return tile.is_accepted(std::to_string(a) + ", " + std::to_string(b));
    };
    for (const bool between : {false, true}) {
        EXPECT_TRUE(with(0, 0, between));
        EXPECT_TRUE(with(-128, 128, between));
        EXPECT_TRUE(with(-64, 63, between));
        EXPECT_FALSE(with(-64, 64, between)); // 0, 0
        EXPECT_FALSE(with(1, 0, between));
        EXPECT_FALSE(with(0, -1, between));
    }
    // Symbol 1 repeats the shares, or a rotation that came after them.
    HandMadeTile repeated(parameters, desc), again(parameters, desc);
    start(repeated).one_coefficient(12).colour(2, 1).coefficient(12, 1).empty_block(24);
    start(again)
        .one_coefficient(12)
        .colour(2, 3)
        .share(0, 0)
        .share(1, 0)
        .coefficient(12, 1)
        .empty_block(24);
    const Outcome want = again.outcome("again");
    EXPECT_TRUE(want.accepted);
    EXPECT_EQ(repeated.outcome("repeated").texels, want.texels);
}

TEST(ForgedPictures, SplitsOfSidesOf1) {
    const CodingParameters parameters;
    for (const auto& [size, allowed] : // the splits 1 to 4
         {std::pair{Extent4{4, 1, 1, 1}, std::string("y-y-")},
          {{1, 4, 1, 1}, "y--y"},
          {{2, 2, 1, 1}, "y-yy"},
          {{1, 1, 1, 1}, "----"},
          {{1, 1, 2, 1}, "-y--"},
          {{1, 1, 1, 3}, "-y--"}})
        for (int kind = 1; kind <= 4; ++kind) {
            const int texels = static_cast<int>(texel_count(size));
            const int parts = size[0] > 1 && size[1] > 1 && kind == 1 ? 4 : 2;
            HandMadeTile tile(parameters, {size, SampleType::unorm8, 1});
            tile.split(kind);
            const int a = kind == 2 ? 0 : 1, b = kind == 2 ? 1 : 0;
            for (int i = 0; i < parts; ++i)
                tile.split(0, a, b);
            // Texels of the parts; the first of the two parts of 3 has one more.
            for (int i = 0; i < parts; ++i)
                tile.empty_block(texels == 3 ? 2 - i : texels / parts);
            EXPECT_EQ(tile.is_accepted(to_string(size) + " split " + std::to_string(kind)),
                      allowed[static_cast<std::size_t>(kind - 1)] == 'y')
                << to_string(size) << " split " << kind;
        }
}

// A node with a side above 64 has no symbol, so its children's come first.
TEST(ForgedPictures, ForcedSplits) {
    const CodingParameters parameters;
    HandMadeTile line(parameters, {{65, 1, 1, 1}, SampleType::unorm8, 1});
    line.split(0, 1).split(0, 1).empty_block(33).empty_block(32);
    EXPECT_TRUE(line.is_accepted("65 x 1"));
    HandMadeTile whole(parameters, {{65, 1, 1, 1}, SampleType::unorm8, 1});
    whole.split(0, 0).empty_block(65).one_coefficient(65).coefficient(65, 2);
    EXPECT_FALSE(whole.is_accepted("65 x 1, not split"));
    HandMadeTile column(parameters, {{3, 129, 1, 1}, SampleType::unorm8, 1});
    // The root and its upper children, 2 x 65 and 1 x 65, have no symbol.
    column.split(0, 2).split(0, 2).split(0, 2).split(0, 2); // the parts of 2 x 65
    column.split(0, 2).split(0, 2);                         // those of 1 x 65
    column.split(0, 1).split(0, 1);                         // 2 x 64, 1 x 64
    for (const int texels : {33, 33, 32, 32, 33, 32, 128, 64})
        column.empty_block(texels);
    EXPECT_TRUE(column.is_accepted("3 x 129"));
}

TEST(ForgedPictures, EveryMode) {
    CodingParameters parameters;
    parameters.prediction = true;
    for (StepCode& step : parameters.step)
        step.bits = 4 << 11;
    // Two blocks of 2 x 4 texels. The first one is not 0, and the second continues it.
    for (int mode = 0; mode < 3 + 32; ++mode) {
        HandMadeTile tile(parameters, {{4, 4, 1, 1}, SampleType::unorm8, 1});
        tile.split(3).split(0, 1).mode(0, 0).split(0, 1);
        if (mode < 3)
            tile.mode(0, mode);
        else
            tile.mode(0, 5).raw(static_cast<std::uint32_t>(mode - 3), 5);
        tile.one_coefficient(8).coefficient(8, 4).empty_block(8);
        const Outcome outcome = tile.outcome("mode " + std::to_string(mode));
        ASSERT_TRUE(outcome.accepted);
        for (std::size_t i = 0; i < 16; ++i)
            EXPECT_EQ(outcome.texels[i] == outcome.texels[0], mode > 0 || i % 4 < 2)
                << "mode " << mode << ", texel " << i;
    }
    // The likely modes without neighbours are vertical and horizontal, 27 and 11.
    for (const int symbol : {3, 4}) {
        HandMadeTile likely(parameters, {{4, 4, 1, 1}, SampleType::unorm8, 1});
        likely.split(3).split(0, 1).mode(0, symbol).split(0, 1);
        likely.mode(2, 3).one_coefficient(8).transform(symbol == 3 ? 2 : 1, 0);
        likely.coefficient(8, 1).empty_block(8);
        EXPECT_TRUE(likely.is_accepted("likely modes"));
    }
}

// A block has a transform symbol if it has a mode, luma, and sides of at most 32. Its context follows
// from its larger side and its mode.
TEST(ForgedPictures, Transforms) {
    CodingParameters parameters;
    parameters.prediction = true;
    for (StepCode& step : parameters.step)
        step.bits = 4 << 11;
    for (std::size_t i = 0; i < 36; ++i) // all tables differ
        parameters.parameters[static_cast<std::size_t>(transform_offset) + i] =
            static_cast<std::uint8_t>(14 + i);
    const auto whole = [&](const Extent4& size, int mode, int context, int symbol) {
        HandMadeTile tile(parameters, {size, SampleType::unorm8, 1});
        const int texels = static_cast<int>(texel_count(size));
        tile.split(0);
        if (mode < 3)
            tile.mode(0, mode);
        else
            tile.mode(0, 5).raw(static_cast<std::uint32_t>(mode - 3), 5);
        tile.one_coefficient(texels);
        if (context >= 0)
            tile.transform(context, symbol);
        tile.coefficient(texels, 4);
        return tile.outcome(to_string(size) + " mode " + std::to_string(mode) + " transform " +
                            std::to_string(symbol));
    };
    const Extent4 sizes[] = {{4, 3, 1, 1}, {5, 2, 1, 1}, {3, 16, 1, 1}, {32, 17, 1, 1}};
    for (int c = 0; c < 4; ++c)
        for (const int mode : {1, 2, 3, 18, 19, 34}) {
            const int context = 3 * c + (mode < 3 ? 0 : mode < 19 ? 1 : 2);
            std::set<Bytes> outcomes;
            for (int symbol = 0; symbol < 4; ++symbol) {
                const Outcome outcome = whole(sizes[c], mode, context, symbol);
                EXPECT_TRUE(outcome.accepted);
                outcomes.insert(outcome.texels);
            }
            EXPECT_EQ(outcomes.size(), 4u) << "context " << context;
        }
    for (const auto& [size, mode] :
         {std::pair{Extent4{33, 4, 1, 1}, 1}, {{4, 33, 1, 1}, 20}, {{8, 8, 1, 1}, 0}})
        EXPECT_TRUE(whole(size, mode, -1, 0).accepted);
    // A side of 1 has cosines.
    const Outcome cosines = whole({8, 1, 1, 1}, 2, 3, 0);
    EXPECT_EQ(whole({8, 1, 1, 1}, 2, 3, 3).texels, cosines.texels);
    EXPECT_EQ(whole({8, 1, 1, 1}, 2, 3, 1).texels, whole({8, 1, 1, 1}, 2, 3, 2).texels);
    EXPECT_NE(whole({8, 1, 1, 1}, 2, 3, 1).texels, cosines.texels);
    // A block without luma has no symbol.
    HandMadeTile empty(parameters, {{8, 8, 1, 1}, SampleType::unorm8, 1});
    EXPECT_TRUE(empty.split(0).mode(0, 2).empty_block(64).is_accepted("no luma"));
}

// With flag 10 seven symbols exist. Where a side is no power of 2, leaving out its transform changes
// nothing.
TEST(ForgedPictures, NoTransform) {
    CodingParameters parameters;
    parameters.prediction = parameters.leaves_out_transforms = true;
    for (StepCode& step : parameters.step)
        step.bits = 9 << 11;
    const auto whole = [&](const Extent4& size, int symbol) {
        HandMadeTile tile(parameters, {size, SampleType::unorm8, 1});
        const int texels = static_cast<int>(texel_count(size));
        const int side = static_cast<int>(std::max(size[axis_u], size[axis_v]));
        const int context = side <= 4 ? 0 : side <= 8 ? 3 : side <= 16 ? 6 : 9;
        tile.split(0).mode(0, 1).one_coefficient(texels).transform(context, symbol);
        tile.coefficient(texels, 3);
        const Outcome outcome = tile.outcome(to_string(size) + " " + std::to_string(symbol));
        EXPECT_TRUE(outcome.accepted);
        return outcome.texels;
    };
    for (const Extent4& size : {Extent4{4, 8, 1, 1}, {8, 2, 1, 1}, {32, 32, 1, 1}, {16, 2, 1, 1}}) {
        std::set<Bytes> outcomes;
        for (int symbol = 0; symbol < transform_kinds; ++symbol)
            outcomes.insert(whole(size, symbol));
        EXPECT_EQ(outcomes.size(), std::size_t{transform_kinds}) << to_string(size);
    }
    EXPECT_EQ(whole({6, 12, 1, 1}, 4), whole({6, 12, 1, 1}, 0));
    EXPECT_EQ(whole({6, 8, 1, 1}, 4), whole({6, 8, 1, 1}, 6));
    EXPECT_EQ(whole({1, 8, 1, 1}, 5), whole({1, 8, 1, 1}, 0));
    parameters.prediction = false;
    HandMadeTile tile(parameters, {{4, 4, 1, 1}, SampleType::unorm8, 1});
    EXPECT_FALSE(tile.split(0).empty_block(16).is_accepted("flag 10 without flag 1"));
}

const TextureDesc two{{8, 8, 1, 1}, SampleType::unorm8, 2};

// Parameters of a file of two channels with predictions.
CodingParameters parameters_of_two() {
    CodingParameters parameters;
    parameters.prediction = true;
    for (StepCode& step : parameters.step)
        step.bits = 9 << 11;
    return parameters;
}

// With flag 11 the symbol follows the first plane that has a length, and there is only one of them.
TEST(ForgedPictures, TransformOfAnyPlane) {
    CodingParameters parameters = parameters_of_two();
    parameters.transforms_any_plane = true;
    std::set<Bytes> outcomes;
    for (int symbol = 0; symbol < usual_transform_kinds; ++symbol) {
        HandMadeTile tile(parameters, two);
        tile.split(0).mode(0, 1).second_plane(64).transform(3, symbol).second_coefficient(64, 3);
        const Outcome outcome = tile.outcome("second plane");
        EXPECT_TRUE(outcome.accepted);
        outcomes.insert(outcome.texels);
    }
    EXPECT_EQ(outcomes.size(), std::size_t{usual_transform_kinds});
    parameters.prediction = false;
    HandMadeTile tile(parameters, two);
    EXPECT_FALSE(tile.split(0).empty_block(64).is_accepted("flag 11 without flag 1"));
}

// With flag 12 each plane may have a tree of its own, behind a raw bit, and all planes have the tables
// of plane 0.
TEST(ForgedPictures, TreesOfPlanes) {
    CodingParameters parameters = parameters_of_two();
    parameters.plane_trees = true;
    std::set<Bytes> outcomes;
    for (int symbol = 0; symbol < usual_transform_kinds; ++symbol) {
        HandMadeTile tile(parameters, two);
        tile.raw(1, 1).split(0).mode(0, 1).split(3).split(0, 1).mode(0, 0).split(0, 1).mode(0, 2);
        tile.one_coefficient(64).transform(3, 0).only_coefficient(64, 2);
        tile.one_coefficient(32).only_coefficient(32, 1);
        tile.one_coefficient(32).transform(3, symbol).only_coefficient(32, 3);
        const Outcome outcome = tile.outcome("a tree for each plane");
        EXPECT_TRUE(outcome.accepted);
        outcomes.insert(outcome.texels);
    }
    EXPECT_EQ(outcomes.size(), std::size_t{usual_transform_kinds});
    HandMadeTile shared(parameters, two);
    shared.raw(0, 1).split(0).mode(0, 0).one_coefficient(64).only_coefficient(64, 2);
    EXPECT_TRUE(shared.one_coefficient(64).only_coefficient(64, 1).is_accepted("one tree"));
    HandMadeTile one(parameters, two);
    one.raw(1, 1).split(0).mode(0, 0).one_coefficient(64).only_coefficient(64, 2);
    EXPECT_FALSE(one.is_accepted("no second tree"));
    const TextureDesc three{{8, 8, 1, 1}, SampleType::unorm8, 3};
    HandMadeTile colours(parameters, three);
    EXPECT_FALSE(colours.split(0).mode(0, 0).empty_block(64).is_accepted("three channels"));
    parameters.prediction = false;
    HandMadeTile tile(parameters, two);
    EXPECT_FALSE(tile.split(0).empty_block(64).is_accepted("flag 12 without flag 1"));
}

// Random bytes in place of a tile. Both decoders must end without a crash and agree.
TEST(ForgedPictures, RandomBytes) {
    Random random(11);
    for (const Extent4& size : {Extent4{37, 53, 1, 1}, Extent4{256, 100, 1, 1},
                                Extent4{20, 18, 3, 3}, Extent4{65, 3, 2, 2}})
        for (int i = 0; i < 150; ++i) {
            CodingParameters parameters;
            parameters.parameters = random_parameters(random);
            parameters.prediction = true;
            parameters.colour_rotation = random.chance(0.5);
            parameters.leaves_out_transforms = random.chance(0.5);
            parameters.transforms_any_plane = random.chance(0.5);
            parameters.base.on = random.chance(0.5);
            parameters.base.margin = static_cast<std::uint8_t>(random.range(0, 31));
            parameters.dependent = random.chance(0.5);
            const TextureDesc desc{size,
                                   random.chance(0.5) ? SampleType::unorm8 : SampleType::half16,
                                   static_cast<std::uint8_t>(random.range(1, 4))};
            const Bytes payload = random.bytes(static_cast<std::size_t>(random.range(1, 600)));
            parameters.plane_trees = desc.channels == 2;
            expect_agreement(HandMadeTile::file_with(parameters, desc, payload), "random bytes");
        }
}

// Valid pictures and camera grids in which some bytes of one tile are changed.
TEST(ForgedPictures, ChangedTiles) {
    Random random(12);
    int accepted = 0;
    for (const auto& [seed, size, tile] : // every eighth seed has base pictures
         {std::tuple{805u, Extent4{74, 53, 2, 2}, Extent4{37, 53, 1, 1}},
          {806u, {90, 40, 1, 2}, {90, 20, 1, 1}},
          {808u, {28, 24, 3, 2}, {14, 12, 3, 2}}})
        for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
            const DecodeCase original = random_case(seed, type, 3, size, tile, 0.6, 0.05, 6, 0.8);
            for (int i = 0; i < 100; ++i) {
                const Bytes file = rewritten(original.file, [&](auto&, auto& tiles) {
                    Bytes& changed = tiles[random() % tiles.size()];
                    for (int change = random.range(1, 3); change > 0 && !changed.empty(); --change)
                        changed[random() % changed.size()] =
                            static_cast<std::byte>(random.range(0, 255));
                });
                accepted += expect_agreement(file, original.name).accepted;
            }
        }
    EXPECT_GT(accepted, 0);
}

} // namespace
} // namespace tessera
