// Runs the decoder's shaders as C++ (tests/support/shader_machine.h) on unchecked payloads and
// compares the results with the CPU decoder. With bit 7 of byte 0 it also changes words of the
// batch, and then checks only that the shaders end and stay inside their buffers.
//
// Input: byte 0: setting (bits 0 to 2), corrections (3), folded (4), predictions, which exclude
// corrections (5), unused (6), changed (7); byte 1: grid; byte 2: number of tiles - 1; if
// `changed`, a count and as many changes (u16 word, u32 value); the payloads, each except the last
// preceded by its u16 length.
#include "format/io/bytes.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/random_predictions.h"
#include "tests/support/random_tile.h"
#include "tests/support/shader_oracle.h"

#include <map>

namespace tessera::fuzz::shader {
namespace {

using test::ShaderOracle;

// Sizes of texture and tile: odd sides, sides of 1, several chunks of corrections, long sides, and
// a base picture that is split into four.
struct Grid {
    Extent4 size, tile;
};
constexpr std::array<Grid, 9> grids = {{{{14, 5, 3, 2}, {7, 5, 3, 2}},
                                        {{9, 6, 5, 7}, {5, 6, 3, 4}},
                                        {{4, 1, 1, 1}, {1, 1, 1, 1}},
                                        {{16, 8, 8, 8}, {8, 8, 8, 8}},
                                        {{17, 9, 8, 4}, {17, 9, 8, 4}},
                                        {{64, 33, 1, 2}, {64, 33, 1, 1}},
                                        {{2, 1, 32, 31}, {1, 1, 32, 31}},
                                        {{6, 4, 4, 4}, {3, 4, 4, 4}},
                                        {{64, 9, 2, 2}, {64, 9, 2, 2}}}};

CodingParameters parameters_of(unsigned setting, bool predictions) {
    CodingParameters parameters;
    for (StepCode& step : parameters.step)
        step = setting == 3 ? StepCode{(max_step_exponent << 11) | 2047}
                            : StepCode::nearest(4 + setting);
    parameters.rotated_step = parameters.step[0];
    parameters.offsets = {{{3, 9}, {31, 0}}};
    parameters.colour_rotation = setting % 4 >= 2;
    parameters.prediction = predictions;
    parameters.leaves_out_transforms = predictions && setting % 3 != 0;
    parameters.transforms_any_plane = predictions && setting % 2 == 1;
    parameters.plane_trees = predictions && setting % 4 == 1; // two planes
    parameters.smooth_copies = predictions && setting % 3 == 1;
    if (predictions && setting % 2 == 0)
        parameters.base = {
            .on = true, .margin = static_cast<std::uint8_t>(setting), .v_against_u = setting == 2};
    parameters.dependent = setting % 2 == 1;
    if (setting % 4 == 1)
        parameters.filter = {{{{{{40, 8}, {-127, 255}, {127, 1}}}, {{{3, 3}, {0, 1}, {90, 200}}}}}};
    parameters.correction_error = static_cast<std::uint16_t>(setting == 5 ? 65535 : setting);
    test::Random random(setting);
    if (setting >= 4)
        parameters.parameters = test::random_parameters(random);
    return parameters;
}

// `first` is byte 0 of an input.
ShaderOracle& oracle(unsigned first, unsigned grid) {
    const unsigned setting = first & 7u;
    const bool predictions = (first & 32u) != 0, corrections = !predictions && (first & 8u) != 0;
    static std::map<std::array<unsigned, 4>, std::unique_ptr<ShaderOracle>> all;
    auto& found = all[{setting, corrections, predictions, grid}];
    if (!found) {
        const TextureDesc desc{grids[grid].size,
                               setting % 3 == 2 ? SampleType::half16 : SampleType::unorm8,
                               static_cast<std::uint8_t>(1 + setting % 4)};
        found = std::make_unique<ShaderOracle>(test::empty_file(
            desc, grids[grid].tile, parameters_of(setting, predictions), corrections));
    }
    return *found;
}

// Reads the input in order. Missing bytes are 0.
class Input {
public:
    explicit Input(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::uint32_t take(std::size_t count) {
        std::uint32_t value = 0;
        const auto part = take_bytes(count);
        for (std::size_t i = 0; i < part.size(); ++i)
            value |= std::to_integer<std::uint32_t>(part[i]) << (8 * i);
        return value;
    }
    std::span<const std::byte> take_bytes(std::size_t count) {
        const auto part = bytes_.first(std::min(count, bytes_.size()));
        bytes_ = bytes_.subspan(part.size());
        return part;
    }

private:
    std::span<const std::byte> bytes_;
};

// The fields of an input.
struct Case {
    unsigned first = 0, grid = 0;
    std::vector<std::pair<std::uint16_t, std::uint32_t>> changes;
    std::vector<Bytes> payloads;

    Bytes input() const {
        Bytes out{static_cast<std::byte>(first), static_cast<std::byte>(grid),
                  static_cast<std::byte>(payloads.size() - 1)};
        if (first & 128u) {
            out.push_back(static_cast<std::byte>(changes.size()));
            for (const auto& [word, value] : changes) {
                append_le(out, word);
                append_le(out, value);
            }
        }
        for (std::size_t i = 0; i < payloads.size(); ++i) {
            if (i + 1 < payloads.size())
                append_le(out, static_cast<std::uint16_t>(payloads[i].size()));
            append_bytes(out, payloads[i]);
        }
        return out;
    }
};

Bytes random_payload(test::Random& random, const ShaderOracle& oracle, std::uint64_t tile,
                     bool corrections) {
    const BlockShape shape = oracle.shape_of_tile(tile);
    const TileCoding& coding = oracle.coding();
    std::vector<std::vector<std::byte>> streams;
    if (corrections) {
        CorrectionMap map(static_cast<std::size_t>(shape.texels() * coding.planes));
        map[map.size() / 2] = -2;
        map[map.size() / 3] += 70000;
        streams = encode_corrections(map, shape, coding.planes, coding.tables);
    }
    const test::RandomTileOptions options{
        .split = 0.6, .density = 0.05, .empty = 0.5, .magnitude_bits = 20};
    const TileLevels levels = coding.predicts
                                  ? test::random_predicted_tile(random, coding, options, shape, 0.6)
                                  : test::RandomTile(random, coding, options).make(shape);
    Bytes payload;
    encode_levels(levels, streams, coding, payload);
    return payload;
}

} // namespace

std::vector<Bytes> seeds() {
    std::vector<Bytes> all;
    test::Random random(8);
    for (unsigned i = 0; i < 96; ++i) {
        Case made;
        made.grid = i % grids.size();
        made.first = (i * 5 % 32) | (i >= 48 ? 32u : 0u) | (i % 2 ? 128u : 0u);
        const bool corrections = (made.first & 40u) == 8u;
        const ShaderOracle& file = oracle(made.first, made.grid);
        const auto tiles = std::min<std::uint64_t>(1 + i % 4, file.reader().tile_count());
        for (std::uint64_t tile = 0; tile < tiles; ++tile)
            made.payloads.push_back(random_payload(random, file, tile, corrections));
        if (i % 4 == 0) // a stored tile
            made.payloads[0].resize(static_cast<std::size_t>(file.shape_of_tile(0).texels()) *
                                    file.reader().desc().texel_bytes());
        // The changes hit header fields and records, with small or arbitrary values.
        for (unsigned k = 0; k < i % 5; ++k)
            made.changes.push_back(
                {static_cast<std::uint16_t>(random.range(0, 63)),
                 random.chance(0.5) ? static_cast<std::uint32_t>(random.range(0, 200)) : random()});
        all.push_back(made.input());
    }
    return all;
}

void run(const std::uint8_t* data, std::size_t size) {
    // Longer inputs take longer without testing more.
    Input input({reinterpret_cast<const std::byte*>(data), std::min<std::size_t>(size, 16384)});
    const std::uint32_t first = input.take(1);
    const std::uint32_t grid = input.take(1) % grids.size();
    ShaderOracle& oracle = shader::oracle(first, grid);
    const ShaderOracle::Layout layout{(first & 16u) != 0};
    const auto tiles = std::min<std::uint64_t>(1 + input.take(1) % 4, oracle.reader().tile_count());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> changes;
    if (first & 128u)
        changes.resize(input.take(1) % 32);
    for (auto& [word, value] : changes)
        word = input.take(2), value = input.take(4);
    std::vector<Bytes> payloads;
    for (std::uint64_t tile = 0; tile < tiles; ++tile) {
        const auto bytes = input.take_bytes(tile + 1 < tiles ? input.take(2) : size);
        payloads.emplace_back(bytes.begin(), bytes.end());
    }
    const auto change = [&](std::span<std::uint32_t> words) {
        for (const auto& [word, value] : changes)
            words[word % words.size()] = value;
    };
    const std::string wrong = first & 128u ? oracle.check_changed(payloads, layout, change, 300000)
                                           : oracle.check(payloads, layout);
    require(wrong.empty(), wrong.c_str());
}

const Registered registered({.name = "fuzz_shader", .seeds = seeds, .run = run, .rounds = 2000});

} // namespace tessera::fuzz::shader
