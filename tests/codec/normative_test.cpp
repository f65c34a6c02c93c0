// The normative numbers below the transform: scales, steps, basis, scan order, entropy coder,
// tables, coding parameters; each against a plain twin.
#include "codec/entropy/context_grid.h"
#include "format/tile/coding_parameters.h"
#include "format/tile/dct_basis.h"
#include "format/tile/rans.h"
#include "tests/support/codec_test_support.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace tessera::test {
namespace {

const std::vector<BlockShape> shapes = {
    shape_of(1, 1, 1, 1),  shape_of(32, 32, 8, 8), shape_of(7, 5, 3, 2),
    shape_of(4, 4, 1, 1),  shape_of(17, 9, 5, 3),  shape_of(1, 1, 32, 32),
    shape_of(32, 1, 1, 1), shape_of(31, 2, 29, 3), shape_of(16, 16, 16, 16)};

// ---------------------------------------------------------------- steps and scales

TEST(StepCode, RoundTripsAndRoundsToNearest) {
    double previous = 0;
    for (int bits = 0; bits < (max_step_exponent + 1) << 11; ++bits) {
        const StepCode code{static_cast<std::uint16_t>(bits)};
        ASSERT_GT(code.value(), previous);
        previous = code.value();
        ASSERT_EQ(StepCode::nearest(code.value()), code) << bits;
    }
    Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const double step = std::exp2(-1 + 20.9 * random.unit());
        const double error = std::fabs(StepCode::nearest(step).value() / step - 1);
        ASSERT_LE(error, 0.5 / 2048 + 1e-12) << step;
    }
    EXPECT_EQ(StepCode::nearest(0.0).value(), 0.5);
    EXPECT_EQ(StepCode::nearest(1e30).value(), previous);
    EXPECT_EQ(StepCode::nearest(1.0).value(), 1.0);
}

TEST(Dequantizer, ScalesAreTheRoundedIdeal) {
    Random random(2);
    for (const BlockShape& shape : shapes)
        for (const SampleType type : {SampleType::unorm8, SampleType::half16})
            for (int round = 0; round < 300; ++round) {
                const StepCode step{static_cast<std::uint16_t>(
                    random.range(0, ((max_step_exponent + 1) << 11) - 1))};
                const bool dependent = random.chance(0.5);
                const ScaleSet scales = make_scales(step, shape, type, dependent);
                for (int axes = 0; axes <= 4; ++axes) {
                    const Scale scale = scales[static_cast<std::size_t>(axes)];
                    const long double ideal = static_cast<long double>(step.value()) *
                                              (dependent ? 0.5L : 1.0L) *
                                              std::exp2l(fraction_bits(type) + axes / 2.0L) /
                                              std::sqrt(static_cast<long double>(shape.texels()));
                    ASSERT_GE(scale.mantissa, 1024);
                    ASSERT_LE(scale.mantissa, 2047);
                    // Half a unit, and the bits that the integer root drops.
                    ASSERT_NEAR(static_cast<double>(std::ldexp(ideal, -scale.exponent)),
                                scale.mantissa, 0.51)
                        << name_of(shape) << " step " << step.value() << " axes " << axes;
                }
            }
}

// Floor division, for any sign of nothing: all values here are positive.
std::int64_t dequantize_twin(std::int64_t magnitude, Scale scale, std::int64_t offset) {
    const std::int64_t product = magnitude * scale.mantissa - scale.mantissa * offset / 64;
    const long double exact = std::ldexp(static_cast<long double>(product), scale.exponent);
    const long double rounded = std::floor(exact + 0.5L);
    return rounded > coefficient_limit ? coefficient_limit : static_cast<std::int64_t>(rounded);
}

TEST(Dequantizer, MatchesExactTwinAndSaturates) {
    Random random(3);
    std::int64_t saturated = 0;
    for (int round = 0; round < 300000; ++round) {
        const Scale scale{random.range(1024, 2047), random.range(-35, 28)};
        const int magnitude =
            round % 7 == 0 ? max_level : random.range(1, 1 << random.range(1, 19));
        const ReconstructionOffsets offsets{static_cast<std::uint8_t>(random.range(0, 31)),
                                            static_cast<std::uint8_t>(random.range(0, 31))};
        const std::int32_t got = dequantize(magnitude, scale, offsets);
        ASSERT_EQ(got, dequantize_twin(magnitude, scale, offsets[magnitude > 1 ? 1 : 0]))
            << magnitude << " * " << scale.mantissa << " * 2^" << scale.exponent;
        ASSERT_GE(got, 0);
        saturated += got == coefficient_limit;
    }
    EXPECT_GT(saturated, 1000);
    for (const int magnitude : {1, 2, 3, 100}) // monotone across the two offsets
        EXPECT_LT(dequantize(magnitude, {1024, 0}, {31, 31}),
                  dequantize(magnitude + 1, {1024, 0}, {31, 31}));
}

TEST(Basis, IsTheRoundedCosineFarFromTies) {
    double nearest_tie = 1;
    for (int n = 1; n <= max_tile_side; ++n)
        for (int k = 0; k < std::min(n, max_frequencies); ++k)
            for (int x = 0; x < n; ++x) {
                const long double exact =
                    32768.0L *
                    std::cos((2 * x + 1) * k * std::numbers::pi_v<long double> / (2 * n));
                ASSERT_EQ(basis(n)[k * n + x], std::lround(exact));
                // Symmetric about the middle: the kernels rely on it.
                ASSERT_EQ(basis(n)[k * n + x], (k % 2 ? -1 : 1) * basis(n)[k * n + n - 1 - x]);
                nearest_tie = std::min(
                    nearest_tie, static_cast<double>(std::fabs(exact - std::floor(exact) - 0.5L)));
            }
    EXPECT_GT(nearest_tie, 1e-5); // a double cosine is off by less than 1e-11
}

// ---------------------------------------------------------------- scan order

TEST(ScanOrder, SortsByCostThenRaster) {
    for (const ScanWeights& weights : {default_scan_weights, ScanWeights{1, 1, 1, 1},
                                       ScanWeights{255, 255, 255, 255}, ScanWeights{1, 255, 7, 90}})
        for (const BlockShape& shape : shapes) {
            const ScanOrder order = make_scan_order(shape, weights);
            ASSERT_EQ(order.length(), std::min(shape.texels(), max_coded_length));
            ASSERT_EQ(order.position_class.size(), order.entry.size());
            ASSERT_EQ(order.support.size(), order.entry.size());
            std::set<int> seen;
            std::array<int, 4> support{};
            std::pair<unsigned, int> last{0, -1};
            for (std::size_t i = 0; i < order.entry.size(); ++i) {
                const auto& k = order.entry[i].k;
                unsigned cost = 0;
                int raster = 0;
                for (std::size_t axis = 4; axis-- > 0;) {
                    ASSERT_LT(k[axis], shape.n[axis]);
                    cost += 8u * weights[axis] * k[axis] / shape.n[axis];
                    raster = raster * shape.n[axis] + k[axis];
                    support[axis] = std::max(support[axis], k[axis] + 1);
                    ASSERT_EQ(order.support[i][axis], support[axis]);
                }
                const std::pair<unsigned, int> now{cost, raster};
                ASSERT_LT(last, now) << name_of(shape) << " entry " << i;
                last = now;
                ASSERT_EQ(order.position_class[i], i == 0 ? 0 : std::min(1 + cost / 24, 19u));
                ASSERT_EQ(order.context[i].position, i == 0 ? 0 : std::min(1 + cost / 96, 5u));
                // What the contexts look at is coded before: one step down along any axis.
                int stride = 1;
                for (std::size_t axis = 0; axis < 4; ++axis) {
                    ASSERT_TRUE(k[axis] == 0 || seen.contains(raster - stride))
                        << name_of(shape) << " entry " << i;
                    stride *= shape.n[axis];
                }
                seen.insert(raster);
            }
            ASSERT_TRUE(seen.contains(0));
            ASSERT_EQ(order.entry[0].k, (std::array<std::uint8_t, 4>{0, 0, 0, 0}));
        }
}

// ---------------------------------------------------------------- contexts

// To two binary digits, at most 192.
int rounded(int amplitude) {
    int most = 0;
    for (const int value : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192})
        most = amplitude >= value ? value : most;
    return most;
}

TEST(ContextGrid, ScatteringEqualsGathering) {
    Random random(5);
    ContextGrid grid; // one for all, as in the codec: begin() must clear
    for (int round = 0; round < 60; ++round) {
        const BlockShape shape = shape_of(random.range(1, 12), random.range(1, 9),
                                          random.range(1, 8), random.range(1, 8));
        const ScanOrder order = make_scan_order(shape, default_scan_weights);
        const int length = random.range(1, order.length());
        grid.begin(order.support[static_cast<std::size_t>(length - 1)]);
        using Key = std::array<int, 4>;
        std::map<Key, int> marked, cross; // amplitudes and their sums, as far as contexts see them
        std::set<Key> coded;
        const auto key = [&](int i) {
            const auto& k = order.entry[static_cast<std::size_t>(i)].k;
            return Key{k[0], k[1], k[2], k[3]};
        };
        for (int plane = 0; plane < 2; ++plane)
            for (int i = 0; i < length; ++i)
                if (random.chance(0.2)) {
                    const int amplitude = random.range(1, 300);
                    grid.mark_cross(grid.place(order.entry[static_cast<std::size_t>(i)]),
                                    static_cast<std::uint32_t>(amplitude));
                    cross[key(i)] = rounded(cross[key(i)] + rounded(amplitude));
                }
        const double density = random.unit();
        for (int i = 0; i < length; ++i) {
            const Key at = key(i);
            int sum = 0, weight = 0;
            const auto near = [&](int times, int u, int v, int s, int t) {
                const Key from{at[0] - u, at[1] - v, at[2] - s, at[3] - t};
                if (!coded.contains(from))
                    return;
                weight += times;
                const auto found = marked.find(from);
                sum += found == marked.end() ? 0 : times * rounded(found->second);
            };
            near(2, 1, 0, 0, 0), near(2, 0, 1, 0, 0), near(2, 0, 0, 1, 0), near(2, 0, 0, 0, 1);
            near(1, 1, 0, 1, 0), near(1, 1, 0, -1, 0), near(1, -1, 0, 1, 0), near(1, 0, 1, 0, 1);
            near(1, 0, 1, 0, -1), near(1, 0, -1, 0, 1), near(1, 1, 1, 0, 0), near(1, 0, 0, 1, 1);
            coded.insert(at);
            const auto& entry = order.entry[static_cast<std::size_t>(i)];
            const auto& context = order.context[static_cast<std::size_t>(i)];
            const int place = grid.place(entry);
            ASSERT_EQ(context.share, weight == 0 ? 0 : 4096 / weight);
            ASSERT_EQ(weight == 0, i == 0);
            // The class of the mean in eighths: the number of values at or below it.
            int want = 0;
            for (const int value : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192})
                want += sum * context.share / 512 >= value;
            ASSERT_EQ(grid.neighbours(place, context), want) << name_of(shape) << " entry " << i;
            int want_cross = 0;
            for (const int value : {1, 3, 6, 12, 24})
                want_cross += cross[at] >= value;
            ASSERT_EQ(grid.cross(place), want_cross) << name_of(shape) << " entry " << i;
            if (random.chance(density)) {
                marked[at] = random.chance(0.1) ? 2 * max_level : random.range(1, 9);
                grid.mark(place, static_cast<std::uint32_t>(marked[at]));
            }
        }
    }
}

// ---------------------------------------------------------------- rANS

struct CodedSymbol {
    std::uint32_t start, frequency;
    int bits; // 12: a table's symbol; else raw
};

std::vector<CodedSymbol> random_symbols(Random& random, int count, double skew) {
    std::vector<CodedSymbol> symbols;
    for (int i = 0; i < count; ++i) {
        if (random.chance(0.1)) {
            const int bits = random.range(1, 16);
            symbols.push_back({random() & ((1u << bits) - 1), 1, bits});
            continue;
        }
        const auto zero = static_cast<std::uint32_t>(random.range(1, 4095));
        const bool one = random.unit() * skew > zero / 4096.0;
        symbols.push_back({one ? zero : 0, one ? 4096 - zero : zero, 12});
    }
    return symbols;
}

Bytes encode(const std::vector<CodedSymbol>& symbols) {
    RansEncoder encoder;
    for (const CodedSymbol& s : symbols)
        encoder.put(s.start, s.frequency, s.bits);
    Bytes out;
    encoder.finish(out);
    return out;
}

void decode(RansDecoder& decoder, const CodedSymbol& s) {
    if (s.bits != 12 || s.frequency == 1) {
        ASSERT_EQ(decoder.raw(s.bits), s.start);
        return;
    }
    ASSERT_GE(decoder.slot(), s.start);
    ASSERT_LT(decoder.slot(), s.start + s.frequency);
    decoder.consume(s.start, s.frequency);
}

TEST(Rans, RandomStreamsRoundTripAndEndExactly) {
    Random random(6);
    for (int round = 0; round < 600; ++round) {
        const auto symbols = random_symbols(random, round < 50 ? round % 5 : random.range(0, 3000),
                                            random.unit() * 1.5);
        const Bytes bytes = encode(symbols);
        ASSERT_EQ(bytes.size() % 2, 0u);
        // Exactly as long as the stream, so that the address sanitizer sees a read past its end.
        RansDecoder decoder(bytes);
        for (const CodedSymbol& s : symbols)
            ASSERT_NO_FATAL_FAILURE(decode(decoder, s));
        ASSERT_TRUE(decoder.ended_well());
        for (int i = 0; i < 20; ++i)
            decoder.bit(2048), decoder.raw(16);

        double bits = 0;
        for (const CodedSymbol& s : symbols)
            bits += s.bits - std::log2(s.frequency);
        ASSERT_LE(static_cast<double>(bytes.size()), bits / 8 * 1.005 + 4);

        if (!symbols.empty() && symbols.back().start != 0) { // one symbol early is noticed
            RansDecoder early(bytes);
            for (std::size_t i = 0; i + 1 < symbols.size(); ++i)
                ASSERT_NO_FATAL_FAILURE(decode(early, symbols[i]));
            ASSERT_FALSE(early.ended_well());
        }
        for (const std::size_t more : {1u, 2u}) { // so is what follows
            Bytes longer = bytes;
            longer.insert(longer.end(), more,
                          std::byte{1}); // zero words behind zeros are no change
            RansDecoder tail(longer);
            for (const CodedSymbol& s : symbols)
                tail.consume(s.frequency == 1 && s.bits != 12 ? 0 : s.start, s.frequency);
            ASSERT_FALSE(tail.ended_well()) << "after " << more << " extra bytes";
        }
    }
}

TEST(Rans, EmptyStreamIsAllFirstSymbols) {
    RansDecoder decoder{std::span<const std::byte>{}};
    for (int i = 0; i < 1000; ++i) {
        ASSERT_EQ(decoder.slot(), 0u);
        ASSERT_FALSE(decoder.bit(1u + static_cast<unsigned>(i) * 4));
        ASSERT_EQ(decoder.raw(i % 17), 0u);
    }
    EXPECT_TRUE(decoder.ended_well());
    RansEncoder encoder;
    for (int i = 0; i < 1000; ++i)
        encoder.bit(false, 4095);
    Bytes bytes;
    encoder.finish(bytes);
    EXPECT_TRUE(bytes.empty());
}

TEST(Rans, AnyBytesDecodeInRange) {
    Random random(7);
    for (int round = 0; round < 200; ++round) {
        const Bytes bytes = random.bytes(static_cast<std::size_t>(random.range(0, 40)));
        RansDecoder decoder(bytes);
        for (int i = 0; i < 200; ++i) {
            ASSERT_LT(decoder.slot(), 4096u);
            decoder.bit(static_cast<std::uint32_t>(random.range(1, 4095)));
            const int bits = random.range(0, 16);
            ASSERT_LT(decoder.raw(bits), 1u << bits);
        }
    }
}

// ---------------------------------------------------------------- tables

template <int symbols> void check_table(const SymbolTable<symbols>& table) {
    ASSERT_EQ(table.start[0], 0);
    ASSERT_EQ(table.start[symbols], probability_total);
    RansEncoder encoder;
    for (int s = 0; s < symbols; ++s) {
        ASSERT_LT(table.start[static_cast<std::size_t>(s)],
                  table.start[static_cast<std::size_t>(s) + 1]);
        table.encode(encoder, s);
    }
    Bytes bytes;
    encoder.finish(bytes);
    RansDecoder decoder(bytes);
    for (int s = 0; s < symbols; ++s)
        ASSERT_EQ(table.decode(decoder), s);
    ASSERT_TRUE(decoder.ended_well());
}

void check_tables(const CodeTables& tables) {
    for (const std::uint16_t zero : tables.zero) {
        ASSERT_GE(zero, 1);
        ASSERT_LE(zero, 4095);
    }
    for (const auto& table : tables.magnitude)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& table : tables.first_length)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& table : tables.other_length)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& row : tables.split)
        for (const auto& table : row)
            ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& table : tables.correction)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& table : tables.colour)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
}

TEST(CodeTables, EverySymbolHasItsShare) {
    ASSERT_NO_FATAL_FAILURE(check_tables(CodeTables(default_parameters())));
    Parameters parameters;
    for (int p = 0; p < parameter_count_of_odds; ++p) {
        parameters.fill(static_cast<std::uint8_t>(p));
        ASSERT_NO_FATAL_FAILURE(check_tables(CodeTables(parameters))) << p;
    }
    Random random(8);
    for (int round = 0; round < 20; ++round)
        ASSERT_NO_FATAL_FAILURE(check_tables(CodeTables(random_parameters(random))));
}

TEST(CodeTables, OddsFollowTheFormula) {
    for (int p = 0; p < parameter_count_of_odds; ++p)
        EXPECT_EQ(stop_frequency(static_cast<std::uint8_t>(p)),
                  std::clamp(std::lround(4096 / (1 + std::pow(2.0L, (p - 32) / 3.0L))), 1L, 4095L));
    EXPECT_EQ(stop_frequency(32), 2048u);
}

// ---------------------------------------------------------------- coding parameters

CodingParameters random_coding_parameters(Random& random, double changed) {
    CodingParameters coding;
    const auto step = [&] {
        return StepCode{
            static_cast<std::uint16_t>(random.range(0, ((max_step_exponent + 1) << 11) - 1))};
    };
    for (StepCode& code : coding.step)
        code = step();
    coding.rotated_step = step();
    coding.colour_rotation = random.chance(0.5);
    coding.prediction = random.chance(0.5);
    coding.smooth_copies = coding.prediction && random.chance(0.5);
    coding.dependent = random.chance(0.5);
    if (random.chance(0.5))
        coding.filter = random_filter(random);
    for (auto& offsets : coding.offsets)
        for (std::uint8_t& offset : offsets)
            offset = static_cast<std::uint8_t>(random.range(0, 31));
    for (std::uint8_t& weight : coding.scan_weights)
        weight = static_cast<std::uint8_t>(random.range(1, 255));
    coding.correction_error = static_cast<std::uint16_t>(random.range(0, 65535));
    for (int i = 0; i < parameter_count; ++i)
        if (random.chance(changed) && (coding.prediction || !is_of_copies(i)))
            coding.parameters[static_cast<std::size_t>(i)] =
                static_cast<std::uint8_t>(random.range(0, 63));
    return coding;
}

void expect_in_range(const CodingParameters& coding) {
    for (const StepCode& code : coding.step)
        ASSERT_LE(code.bits >> 11, max_step_exponent);
    ASSERT_LE(coding.rotated_step.bits >> 11, max_step_exponent);
    for (const auto& offsets : coding.offsets)
        for (const std::uint8_t offset : offsets)
            ASSERT_LE(offset, 31);
    for (const std::uint8_t weight : coding.scan_weights)
        ASSERT_GE(weight, 1);
    for (const std::uint8_t p : coding.parameters)
        ASSERT_LE(p, 63);
}

TEST(CodingParameters, RoundTrip) {
    Random random(9);
    for (int round = 0; round < 60; ++round) {
        const CodingParameters want =
            round == 0 ? CodingParameters{} : random_coding_parameters(random, round % 4 * 0.3);
        const Bytes bytes = write_coding_parameters(want);
        const Result<CodingParameters> got = read_coding_parameters(bytes);
        ASSERT_TRUE(got) << got.status().message();
        EXPECT_EQ(got->step, want.step);
        EXPECT_EQ(got->rotated_step, want.rotated_step);
        EXPECT_EQ(got->colour_rotation, want.colour_rotation);
        EXPECT_EQ(got->prediction, want.prediction);
        EXPECT_EQ(got->smooth_copies, want.smooth_copies);
        EXPECT_EQ(got->dependent, want.dependent);
        EXPECT_EQ(got->filter, want.filter);
        EXPECT_EQ(got->offsets, want.offsets);
        EXPECT_EQ(got->scan_weights, want.scan_weights);
        EXPECT_EQ(got->correction_error, want.correction_error);
        EXPECT_EQ(got->parameters, want.parameters);
    }
    // Defaults cost nothing beyond the fixed part.
    EXPECT_LE(write_coding_parameters({}).size(), 24u);
}

TEST(CodingParameters, ThoseOfCopiesAreLeftOutWithoutPredictions) {
    CodingParameters coding;
    int left_out = 0;
    for (int i = 0; i < parameter_count; ++i)
        if (is_of_copies(i)) {
            std::uint8_t& parameter = coding.parameters[static_cast<std::size_t>(i)];
            parameter = static_cast<std::uint8_t>((parameter + 1) % 64);
            ++left_out;
        }
    EXPECT_EQ(left_out, 1344 + 1188 + 117 + 12 + 4 + 16); // FORMAT.md 3.5
    EXPECT_EQ(write_coding_parameters(coding).size(), write_coding_parameters({}).size());
    coding.prediction = true;
    const Result<CodingParameters> got = read_coding_parameters(write_coding_parameters(coding));
    ASSERT_TRUE(got) << got.status().message();
    EXPECT_EQ(got->parameters, coding.parameters);
}

TEST(CodingParameters, SmoothCopiesNeedPredictions) {
    constexpr std::size_t flags = 23;
    Bytes bytes = write_coding_parameters({});
    for (const int value : {8, 12, 32, 64}) {
        bytes[flags] = static_cast<std::byte>(value);
        EXPECT_FALSE(read_coding_parameters(bytes)) << value;
    }
    bytes[flags] = std::byte{10};
    const Result<CodingParameters> both = read_coding_parameters(bytes);
    ASSERT_TRUE(both) << both.status().message();
    EXPECT_TRUE(both->smooth_copies);
}

TEST(CodingParameters, FiltersHaveARangeAndAnEffect) {
    constexpr std::size_t rings = 24;
    CodingParameters coding;
    coding.filter.ring[1][2] = {-127, 255};
    const Bytes bytes = write_coding_parameters(coding);
    EXPECT_EQ(bytes.size(), write_coding_parameters({}).size() + 12);
    const Result<CodingParameters> got = read_coding_parameters(bytes);
    ASSERT_TRUE(got) << got.status().message();
    EXPECT_EQ(got->filter, coding.filter);
    const auto expect_refused = [&](std::size_t at, int value, const char* why) {
        Bytes changed = bytes;
        changed[at] = static_cast<std::byte>(value);
        EXPECT_FALSE(read_coding_parameters(changed)) << why;
    };
    expect_refused(rings, 128, "strength -128");
    expect_refused(rings + 1, 0, "reach 0");
    expect_refused(rings + 10, 0, "no ring has a strength");
}

TEST(CodingParameters, DamageIsRefusedOrHarmless) {
    Random random(10);
    const Bytes bytes = write_coding_parameters(random_coding_parameters(random, 0.3));
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
        const Result<CodingParameters> got = read_coding_parameters(cut);
        if (got)
            expect_in_range(*got);
        else
            ASSERT_EQ(got.status().code(), ErrorCode::invalid_file);
        // Half a word or a missing field is always noticed.
        ASSERT_TRUE(!got || (length % 2 == bytes.size() % 2 && length >= 24)) << length;
    }
    for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
        Bytes flipped = bytes;
        flipped[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
        if (const Result<CodingParameters> got = read_coding_parameters(flipped))
            expect_in_range(*got);
    }
    for (int round = 0; round < 500; ++round)
        if (const auto got = read_coding_parameters(
                random.bytes(static_cast<std::size_t>(random.range(0, 400)))))
            expect_in_range(*got);
}

} // namespace
} // namespace tessera::test
