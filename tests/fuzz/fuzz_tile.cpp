// Decodes the payload of one tile: segments, levels, reconstruction and corrections. The first byte
// of the input chooses the coding and the tile's shape.
#include "codec/reconstruct/tile_decoder.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/random_predictions.h"

#include <memory>

namespace tessera::fuzz::tile {
namespace {

// The last two have a base picture that is split into four, and more texels than a tile with
// corrections may have.
constexpr std::array<std::array<std::uint16_t, 4>, 9> shapes = {{{7, 5, 3, 2},
                                                                 {8, 8, 8, 8},
                                                                 {32, 32, 8, 8},
                                                                 {1, 1, 1, 1},
                                                                 {17, 9, 5, 3},
                                                                 {64, 9, 2, 2},
                                                                 {64, 64, 5, 4},
                                                                 {150, 83, 1, 1},
                                                                 {40, 64, 1, 1}}};

constexpr int settings_count = 12; // the last four have predictions

struct Setting {
    std::unique_ptr<TileCoding> coding;
    ColourCoding colour;
    std::unique_ptr<TileDecoder> decoder;
};

const std::vector<Setting>& settings() {
    static const std::vector<Setting> all = [] {
        std::vector<Setting> made;
        test::Random random(5);
        for (int i = 0; i < settings_count; ++i) {
            CodingParameters parameters;
            parameters.prediction = i >= 8;
            parameters.leaves_out_transforms = i == 8 || i == 11;
            parameters.transforms_any_plane = i == 8 || i == 10;
            parameters.plane_trees = i == 9; // two planes
            parameters.smooth_copies = i == 9;
            if (i >= 9)
                parameters.base = {
                    .on = true, .margin = static_cast<std::uint8_t>(i - 9), .v_against_u = i == 10};
            for (StepCode& step : parameters.step)
                step =
                    i == 3 ? StepCode{(max_step_exponent << 11) | 2047} : StepCode::nearest(4 + i);
            parameters.rotated_step = parameters.step[0];
            parameters.colour_rotation = i % 2 == 1;
            parameters.dependent = i % 4 >= 2;
            parameters.correction_error = static_cast<std::uint16_t>(i == 5 ? 65535 : i);
            if (i >= 4)
                parameters.parameters = test::random_parameters(random);
            Setting setting;
            const int planes = 1 + i % 4;
            const SampleType type = i % 3 == 2 ? SampleType::half16 : SampleType::unorm8;
            setting.coding = std::make_unique<TileCoding>(parameters, type, planes);
            setting.colour = {{{1, 1, 1, 1}, type, static_cast<std::uint8_t>(planes)},
                              planes >= 3 ? ColourTransform::ycocg_r : ColourTransform::none,
                              {9, 8, 7, 6},
                              true,
                              true};
            made.push_back(std::move(setting));
        }
        // Decoders refer to the codings and colours, so they are created last.
        for (Setting& setting : made)
            setting.decoder = std::make_unique<TileDecoder>(*setting.coding, setting.colour);
        return made;
    }();
    return all;
}

BlockShape shape_of_input(unsigned first) {
    return {shapes[first / settings_count % shapes.size()]};
}

} // namespace

std::vector<Bytes> seeds() {
    std::vector<Bytes> all;
    test::Random random(6);
    for (unsigned first = 0; first < settings_count * shapes.size(); ++first) {
        const TileCoding& coding = *settings()[first % settings_count].coding;
        const BlockShape shape = shape_of_input(first);
        const test::RandomTileOptions options{.split = 0.5, .density = 0.02, .empty = 0.5};
        const TileLevels tile =
            coding.predicts ? test::random_predicted_tile(random, coding, options, shape, 0.6)
                            : test::RandomTile(random, coding, options).make(shape);
        std::vector<std::vector<std::byte>> corrections;
        if (first % 3 == 0 && shape.texels() <= max_corrected_texels) {
            CorrectionMap map(static_cast<std::size_t>(shape.texels() * coding.planes));
            map[map.size() / 2] = -2;
            corrections = encode_corrections(map, shape, coding.planes, coding.tables);
        }
        Bytes input{static_cast<std::byte>(first)};
        encode_levels(tile, corrections, coding, input);
        all.push_back(input);
        if (first % 5 == 0) { // a stored tile
            const TextureDesc& desc = settings()[first % settings_count].colour.desc;
            input.resize(1 + static_cast<std::size_t>(shape.texels()) * desc.texel_bytes());
            all.push_back(input);
        }
    }
    return all;
}

void run(const std::uint8_t* data, std::size_t size) {
    if (size == 0)
        return;
    const Setting& setting = settings()[data[0] % settings_count];
    const BlockShape shape = shape_of_input(data[0]);
    // A copy of the exact size lets the address sanitizer detect reads past the end.
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    const std::vector<std::byte> payload(bytes + 1, bytes + size);
    std::vector<std::byte> texels(static_cast<std::size_t>(shape.texels()) *
                                  setting.colour.desc.texel_bytes());
    const Status status = setting.decoder->decode(payload, shape, texels);
    require(status.ok() || status.code() == ErrorCode::invalid_file, "wrong kind of error");
    if (!status.ok())
        return;
    const TileLevels& levels = setting.decoder->levels();
    require(levels.blocks.size() <= max_leaves, "too many blocks");
    int covered = 0;
    for (std::size_t i = levels.base_blocks; i < levels.blocks.size(); ++i)
        covered += levels.blocks[i].shape.texels();
    const int trees = levels.second_tree > 0 ? 2 : 1;
    require(covered == trees * shape.texels(), "blocks do not tile the tile");
}

const Registered registered({.name = "fuzz_tile", .seeds = seeds, .run = run});

} // namespace tessera::fuzz::tile
