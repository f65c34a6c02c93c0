// Files that the shaders must decode exactly as the CPU does: encoded textures of every sample
// type, channel count and tile shape, and tiles with random trees, colours and levels that no
// encoder writes.
#pragma once

#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/reconstruct/tile_decoder.h"
#include "format/tile/coding_parameters.h"
#include "tests/support/efforts.h"
#include "tests/support/format_values.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/random_predictions.h"
#include "tests/support/random_tile.h"
#include "tests/support/vector_sink.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tessera::test {

struct DecodeCase {
    std::string name;
    Bytes file;
};

inline DecodeCase encoded_case(const std::string& texture, const TextureDesc& desc, RateTarget rate,
                               const Extent4& tile = {32, 32, 8, 8}, int effort = quick_effort) {
    MemoryTexture source = named_texture(desc, texture);
    EncodeOptions options;
    options.rate = rate;
    options.threads = 2;
    options.tile_extent = tile;
    options.effort = effort;
    DecodeCase made;
    made.name = texture + " " + to_string(desc.size) + " x" + std::to_string(desc.channels) +
                (desc.type == SampleType::half16 ? " half" : "") + " rate " +
                std::to_string(rate.value) + " tiles " + to_string(tile) + " effort " +
                std::to_string(effort);
    const auto report = encode_memory(source, made.file, options);
    EXPECT_TRUE(report) << made.name << ": " << report.status().message();
    return made;
}

// Calls visit(type, channels) for all sample types and numbers of channels.
template <class Visit> void for_each_kind(Visit visit) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (std::uint8_t channels = 1; channels <= 4; ++channels)
            visit(type, channels);
}

inline std::vector<DecodeCase> encoded_cases() {
    using Kind = RateTarget::Kind;
    std::vector<DecodeCase> cases;
    for_each_kind([&](SampleType type, std::uint8_t channels) {
        cases.push_back(
            encoded_case("smooth", {{33, 11, 9, 4}, type, channels}, {Kind::quality, 60}));
        cases.push_back(encoded_case("noise", {{9, 6, 5, 7}, type, channels},
                                     {Kind::max_error, type == SampleType::unorm8 ? 2. : 40.}));
        if (channels >= 2) // gives stored tiles
            cases.push_back(
                encoded_case("noise", {{9, 6, 5, 3}, type, channels}, {Kind::max_error, 0}));
    });
    const TextureDesc rgb{{34, 9, 9, 5}, SampleType::unorm8, 3};
    for (const char* name :
         {"black", "constant", "lambert", "checkerboard", "bright_texel", "grazing_ramp", "noise"})
        cases.push_back(
            encoded_case(name, rgb, {Kind::quality, 75}, {32, 32, 8, 8}, copies_effort));
    cases.push_back(encoded_case("noise", rgb, {Kind::max_error, 4}));
    cases.push_back(encoded_case("smooth", {{4, 3, 32, 40}, SampleType::unorm8, 3},
                                 {Kind::quality, 90}, {4, 4, 32, 32}));
    cases.push_back(encoded_case("noise", {{64, 40, 3, 1}, SampleType::unorm8, 3},
                                 {Kind::quality, 50}, {32, 32, 8, 8}));
    cases.push_back(
        encoded_case("smooth", {{1, 1, 1, 1}, SampleType::half16, 4}, {Kind::quality, 75}));
    // Sides above 32, without and with copies.
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        const bool bytes = type == SampleType::unorm8;
        cases.push_back(encoded_case("smooth", {{64, 64, 3, 2}, type, 3}, {Kind::quality, 70},
                                     {64, 64, 4, 4}, bytes ? copies_effort : quick_effort));
        cases.push_back(encoded_case("grazing_ramp", {{125, 45, 2, 2}, type, 3},
                                     {Kind::quality, 60}, {63, 45, 5, 3},
                                     bytes ? quick_effort : copies_effort));
    }
    cases.push_back(encoded_case("lambert", {{64, 1, 32, 17}, SampleType::unorm8, 3},
                                 {Kind::quality, 70}, {64, 1, 32, 32}));
    cases.push_back(encoded_case("noise", {{50, 33, 3, 2}, SampleType::unorm8, 3},
                                 {Kind::max_error, 4}, {64, 64, 4, 4}, quick_effort));
    return cases;
}

// A file whose tiles no encoder writes: random trees, rotations and levels of up to 20 bits. If
// `copies` is above 0, each block copies with that probability, and half of the seeds also have
// base pictures. Two thirds of the seeds have a filter. A tenth of the tiles are stored, with
// random bytes.
inline DecodeCase random_case(std::uint32_t seed, SampleType type, std::uint8_t channels,
                              const Extent4& size, const Extent4& tile_extent, double split,
                              double density, int magnitude_bits, double copies = 0) {
    Random random(seed);
    CodingParameters parameters;
    if (seed % 5 == 0)
        parameters.use_defaults(DefaultSet::pictures);
    parameters.parameters = random_parameters(random);
    parameters.colour_rotation = channels >= 3;
    parameters.prediction = copies > 0;
    parameters.leaves_out_transforms = copies > 0 && seed % 3 == 1;
    parameters.transforms_any_plane = copies > 0 && seed % 5 >= 3;
    parameters.plane_trees = copies > 0 && channels == 2;
    parameters.smooth_copies = copies > 0 && seed % 4 >= 2;
    if (copies > 0 && seed % 8 < 4)
        parameters.base = {.on = true,
                           .margin = static_cast<std::uint8_t>(random.range(0, 5)),
                           .v_against_u = random.chance(0.5)};
    parameters.dependent = seed % 2 == 1;
    if (seed % 3 != 0)
        parameters.filter = random_filter(random);
    for (StepCode& step : parameters.step)
        step.bits = static_cast<std::uint16_t>((random.range(0, 8) << 11) | random.range(0, 2047));
    parameters.rotated_step.bits =
        static_cast<std::uint16_t>((random.range(0, 8) << 11) | random.range(0, 2047));
    for (ReconstructionOffsets& offsets : parameters.offsets)
        for (std::uint8_t& offset : offsets)
            offset = static_cast<std::uint8_t>(random.range(0, 31));
    const TextureDesc desc{size, type, channels};
    const TileCoding coding(parameters, type, channels);
    const TileGrid grid(size, tile_extent);
    std::vector<Bytes> tiles(grid.tiles());
    for (std::uint64_t i = 0; i < grid.tiles(); ++i)
        if (random.chance(0.1)) {
            tiles[i].resize(desc.box_bytes(grid.box(i)));
            for (std::byte& byte : tiles[i])
                byte = static_cast<std::byte>(random.range(0, 255));
        } else if (!random.chance(0.1)) {
            const BlockShape shape = tile_shape(grid.box(i));
            const RandomTileOptions options{
                .split = split, .density = density, .magnitude_bits = magnitude_bits};
            encode_levels(copies > 0 ? random_predicted_tile(random, coding, options, shape, copies)
                                     : RandomTile(random, coding, options).make(shape),
                          {}, coding, tiles[i]);
        }
    const auto section = write_coding_parameters(parameters, channels, false);
    ContainerContents contents;
    contents.desc = desc;
    contents.tile_extent = tile_extent;
    contents.colour = channels >= 3 ? ColourTransform::ycocg_r : ColourTransform::none;
    for (std::size_t i = 0; i < channels; ++i)
        contents.background[i] = static_cast<std::uint16_t>(random.range(0, 255));
    contents.required_features = features_of(parameters) | feature_stored;
    contents.codec_parameters = section;
    contents.tile = [&](std::uint64_t tile) { return std::span<const std::byte>(tiles[tile]); };
    DecodeCase made;
    made.name = "random " + std::to_string(seed);
    VectorSink sink(made.file);
    const auto written = write_container(contents, sink);
    EXPECT_TRUE(written) << written.status().message();
    return made;
}

inline std::vector<DecodeCase> random_cases() {
    std::vector<DecodeCase> cases;
    std::uint32_t seed = 100;
    for_each_kind([&](SampleType type, std::uint8_t channels) {
        cases.push_back(
            random_case(++seed, type, channels, {64, 20, 9, 3}, {32, 32, 8, 8}, 0.6, 0.1, 4));
        cases.push_back(
            random_case(++seed, type, channels, {13, 21, 9, 6}, {13, 7, 5, 6}, 0.9, 0.3, 20));
    });
    cases.push_back(
        random_case(++seed, SampleType::unorm8, 3, {32, 32, 8, 8}, {32, 32, 8, 8}, 0.97, 0.02, 2));
    cases.push_back(
        random_case(++seed, SampleType::unorm8, 4, {2, 32, 32, 32}, {2, 32, 32, 32}, 0, 0.02, 3));
    cases.push_back(
        random_case(++seed, SampleType::unorm8, 4, {32, 32, 8, 8}, {32, 32, 8, 8}, 0.5, 0.9, 3));
    // Sides above 32: undivided blocks, blocks of many lengths, and trees of 11 levels.
    cases.push_back(
        random_case(++seed, SampleType::half16, 3, {64, 64, 2, 2}, {64, 64, 4, 4}, 0, 0.03, 8));
    cases.push_back(
        random_case(++seed, SampleType::unorm8, 4, {125, 45, 3, 2}, {63, 45, 5, 3}, 0.4, 0.03, 6));
    cases.push_back(
        random_case(++seed, SampleType::unorm8, 3, {64, 1, 32, 32}, {64, 1, 32, 32}, 0.8, 0.02, 4));
    cases.push_back(
        random_case(++seed, SampleType::half16, 1, {33, 51, 6, 4}, {33, 51, 6, 4}, 0.6, 0.05, 20));
    cases.push_back(
        random_case(++seed, SampleType::unorm8, 2, {64, 3, 32, 1}, {64, 2, 32, 1}, 0.99, 0.1, 4));
    // More texels and more segments than a tile with corrections may have.
    cases.push_back(
        random_case(++seed, SampleType::unorm8, 3, {64, 64, 5, 4}, {64, 64, 5, 4}, 0.8, 0.05, 4));
    return cases;
}

// Files in which some tiles have predictions, with copies up to 15 deep and with modes in pictures.
inline std::vector<DecodeCase> predicted_cases() {
    std::vector<DecodeCase> cases;
    std::uint32_t seed = 200;
    for_each_kind([&](SampleType type, std::uint8_t channels) {
        cases.push_back(random_case(++seed, type, channels, {40, 12, 11, 5}, {32, 32, 8, 8}, 0.8,
                                    0.02, 6, 0.7));
        cases.push_back(
            random_case(++seed, type, channels, {13, 21, 9, 6}, {13, 7, 5, 6}, 0.9, 0.1, 20, 0.3));
        // Long chains of copies of large values.
        cases.push_back(random_case(++seed, type, channels, {3, 5, 32, 17}, {3, 5, 32, 17}, 0.98,
                                    0.1, 18, 0.9));
    });
    // Sides above 32, with predictions.
    cases.push_back(random_case(++seed, SampleType::unorm8, 3, {125, 45, 5, 3}, {63, 45, 5, 3}, 0.7,
                                0.02, 6, 0.7));
    cases.push_back(random_case(++seed, SampleType::half16, 4, {64, 64, 4, 2}, {64, 64, 4, 4}, 0.7,
                                0.01, 12, 0.7));
    cases.push_back(random_case(++seed, SampleType::unorm8, 1, {64, 1, 32, 32}, {64, 1, 32, 32},
                                0.9, 0.02, 6, 0.8));
    // Large tiles with base pictures larger than a block, most of them with a margin.
    for (const auto& [size, split] :
         {std::pair{Extent4{64, 20, 3, 2}, 0.7}, {{62, 63, 5, 4}, 0.7}, {{62, 63, 5, 4}, 0.0}}) {
        while (++seed % 8 >= 4) {
        }
        cases.push_back(random_case(seed, SampleType::unorm8, 3, size, size, split, 0.02, 6, 0.7));
    }
    // Pictures, some of them in tiles with sides above 64. Values reach the limits of both types.
    for_each_kind([&](SampleType type, std::uint8_t channels) {
        cases.push_back(random_case(++seed, type, channels, {37, 53, 1, 1}, {37, 53, 1, 1}, 0.9,
                                    0.05, 20, 0.8));
        cases.push_back(random_case(++seed, type, channels, {256, 100, 1, 1}, {256, 100, 1, 1}, 0.8,
                                    0.01, 6, 0.6));
    });
    cases.push_back(random_case(++seed, SampleType::unorm8, 3, {256, 256, 1, 1}, {256, 256, 1, 1},
                                0, 0.002, 4, 1));
    cases.push_back(random_case(++seed, SampleType::half16, 3, {130, 70, 2, 1}, {65, 70, 1, 1}, 0.9,
                                0.01, 16, 0.9));
    cases.push_back(random_case(++seed, SampleType::unorm8, 3, {130, 70, 2, 1}, {130, 70, 2, 1},
                                0.9, 0.01, 6, 0.7)); // several views, and forced splits
    cases.push_back(random_case(++seed, SampleType::unorm8, 1, {256, 1, 1, 1}, {256, 1, 1, 1}, 0.9,
                                0.1, 6, 0.9));
    return cases;
}

// Pictures, which are tiles of one view or base pictures, whose blocks are predicted from their
// border: random tiles, some with sides above 64, and encoded pictures and camera grids.
inline std::vector<DecodeCase> picture_cases() {
    std::vector<DecodeCase> cases;
    std::uint32_t seed = 300;
    for_each_kind([&](SampleType type, std::uint8_t channels) {
        cases.push_back(
            random_case(++seed, type, channels, {77, 45, 1, 1}, {40, 45, 1, 1}, 0.8, 0.05, 6, 0.8));
        cases.push_back(random_case(++seed, type, channels, {33, 37, 1, 1}, {64, 64, 1, 1}, 0.95,
                                    0.3, 20, 0.9));
    });
    cases.push_back(random_case(++seed, SampleType::unorm8, 3, {256, 256, 1, 1}, {256, 256, 1, 1},
                                0.9, 0.02, 5, 0.9));
    cases.push_back(random_case(++seed, SampleType::half16, 3, {300, 131, 1, 1}, {256, 256, 1, 1},
                                0.9, 0.02, 5, 0.9));
    cases.push_back(random_case(++seed, SampleType::unorm8, 1, {256, 3, 1, 1}, {256, 3, 1, 1}, 0.95,
                                0.1, 5, 0.9));
    // Tiles of several views with sides above 64.
    cases.push_back(random_case(++seed, SampleType::unorm8, 3, {200, 70, 2, 1}, {256, 128, 2, 1},
                                0.7, 0.02, 5, 0.7));
    cases.push_back(random_case(++seed, SampleType::half16, 4, {129, 65, 3, 2}, {256, 256, 3, 2},
                                0.7, 0.02, 5));
    using Kind = RateTarget::Kind;
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const std::uint8_t channels : {std::uint8_t{1}, std::uint8_t{3}})
            cases.push_back(encoded_case("smooth", {{97, 61, 1, 1}, type, channels},
                                         {Kind::quality, 60}, {128, 128, 1, 1}, copies_effort));
    cases.push_back(encoded_case("noise", {{256, 256, 1, 1}, SampleType::unorm8, 3},
                                 {Kind::quality, 40}, {256, 256, 1, 1}, copies_effort));
    cases.push_back(encoded_case("grazing_ramp", {{60, 60, 5, 5}, SampleType::unorm8, 3},
                                 {Kind::quality, 50}, {64, 64, 5, 5}, copies_effort));
    return cases;
}

// The texels of `box` as the four stored channels, decoded on the CPU.
inline std::vector<std::array<std::uint32_t, 4>> expected_samples(const Decoder& decoder,
                                                                  const Box4& box) {
    const TextureDesc& desc = decoder.desc();
    Bytes texels(desc.box_bytes(box));
    const Status status = decoder.decode_grid_box(box, texels, ReadOptions());
    EXPECT_TRUE(status) << status.message();
    const bool bytes = desc.type == SampleType::unorm8;
    const std::uint32_t one = bytes ? 255 : 0x3C00;
    std::vector<std::array<std::uint32_t, 4>> out(box.texels());
    for (std::size_t i = 0; i < out.size(); ++i) {
        std::array<std::uint32_t, 4> c{};
        for (std::size_t k = 0; k < desc.channels; ++k)
            c[k] = load_sample(texels.data() + (i * desc.channels + k) * sample_bytes(desc.type),
                               desc.type);
        switch (desc.channels) {
        case 1:
            c = {c[0], c[0], c[0], one};
            break;
        case 2:
            c = {c[0], c[0], c[0], c[1]};
            break;
        case 3:
            c[3] = one;
            break;
        default:
            break;
        }
        out[i] = c;
    }
    return out;
}

} // namespace tessera::test
