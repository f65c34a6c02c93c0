#include "format/tile/coding_parameters.h"

#include "format/io/bytes.h"
#include "format/tile/features.h"

#include <cmath>
#include <cstdlib>

namespace tessera {
namespace {

// The fixed part: 5 steps, 2 x 2 offsets, 4 weights, correction error, difference model, flags.
constexpr std::size_t fixed_code_bytes = 10 + 4 + 4 + 2 + 3 + 1;
constexpr std::size_t filter_bytes = 2 * plane_classes * filter_rings;

// The probabilities with which the differences from the defaults are coded, which the writer fits
// to them: that a difference is 0 after a difference of 0, that it is 0 after another difference,
// and that a magnitude does not grow further.
struct DifferenceModel {
    std::array<std::uint8_t, 3> parameter{};
};
constexpr std::size_t after_same = 0, after_change = 1, more = 2; // indices of `parameter`

// The parameter that costs least for a decision that was 0 `stops` times and 1 `goes` times.
std::uint8_t fit(double stops, double goes) {
    std::uint8_t best = 0;
    double least = 1e300;
    for (int p = 0; p < parameter_count_of_odds; ++p) {
        const double stop =
            stop_frequency(static_cast<std::uint8_t>(p)) / static_cast<double>(probability_total);
        const double bits = -stops * std::log2(stop) - goes * std::log2(1.0 - stop);
        if (bits < least) {
            least = bits;
            best = static_cast<std::uint8_t>(p);
        }
    }
    return best;
}

// Whether section CODE stores a parameter. The others have their default values.
bool holds(const CodingParameters& coding, std::size_t parameter) {
    const int i = static_cast<int>(parameter);
    return (coding.prediction || !is_of_copies(i)) && (coding.base.on || !is_of_bases(i));
}

// Calls decide(index in DifferenceModel, decision) and sign(is negative) in the order in which they
// are coded.
template <class Decide, class Sign>
void walk(const CodingParameters& coding, Decide decide, Sign sign) {
    const Parameters& parameters = coding.parameters;
    bool changed = false;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (!holds(coding, i))
            continue;
        const int difference = parameters[i] - default_parameters()[i];
        decide(changed ? after_change : after_same, difference != 0);
        changed = difference != 0;
        if (!changed)
            continue;
        for (int m = 1; m < std::abs(difference); ++m)
            decide(more, true);
        if (std::abs(difference) < parameter_count_of_odds - 1)
            decide(more, false);
        sign(difference < 0);
    }
}

} // namespace

std::vector<std::byte> write_coding_parameters(const CodingParameters& coding) {
    std::array<double, 3> stops{}, goes{};
    walk(
        coding, [&](std::size_t which, bool go) { (go ? goes : stops)[which] += 1.0; },
        [](bool) {});
    DifferenceModel model;
    for (std::size_t i = 0; i < model.parameter.size(); ++i)
        model.parameter[i] = fit(stops[i], goes[i]);

    std::vector<std::byte> out;
    const auto put = [&out](unsigned value, int bytes) {
        for (int i = 0; i < bytes; ++i)
            out.push_back(static_cast<std::byte>(value >> (8 * i) & 255));
    };
    for (const StepCode& step : coding.step)
        put(step.bits, 2);
    put(coding.rotated_step.bits, 2);
    for (const auto& offsets : coding.offsets)
        for (const std::uint8_t offset : offsets)
            put(offset, 1);
    for (const std::uint8_t weight : coding.scan_weights)
        put(weight, 1);
    put(coding.correction_error, 2);
    for (const std::uint8_t parameter : model.parameter)
        put(parameter, 1);
    put((coding.colour_rotation ? 1u : 0u) | (coding.prediction ? 2u : 0u) |
            (coding.dependent ? 4u : 0u) | (coding.smooth_copies ? 8u : 0u) |
            (coding.filter.is_on() ? 16u : 0u) | (coding.base.on ? 32u : 0u) |
            (coding.base.v_against_u ? 64u : 0u),
        1);
    if (coding.base.on)
        put(coding.base.margin, 1);
    if (coding.filter.is_on())
        for (const auto& rings : coding.filter.ring)
            for (const FilterRing& ring : rings) {
                put(static_cast<std::uint8_t>(ring.strength), 1);
                put(ring.reach, 1);
            }

    RansEncoder encoder;
    walk(
        coding,
        [&](std::size_t which, bool go) {
            encoder.bit(go, stop_frequency(model.parameter[which]));
        },
        [&](bool negative) { encoder.raw(negative, 1); });
    encoder.finish(out);
    return out;
}

Result<CodingParameters> read_coding_parameters(std::span<const std::byte> bytes) {
    const auto damaged = [](const char* what) {
        return Status(ErrorCode::invalid_file, std::string("section CODE: ") + what);
    };
    if (bytes.size() < fixed_code_bytes)
        return damaged("too short");
    CodingParameters coding;
    std::size_t at = 0;
    const auto get = [&](int count) {
        unsigned value = 0;
        for (int i = 0; i < count; ++i)
            value |= std::to_integer<unsigned>(bytes[at++]) << (8 * i);
        return value;
    };
    const auto get_step = [&](StepCode& step) {
        step.bits = static_cast<std::uint16_t>(get(2));
        return (step.bits >> 11) <= max_step_exponent;
    };
    for (StepCode& step : coding.step)
        if (!get_step(step))
            return damaged("step out of range");
    if (!get_step(coding.rotated_step))
        return damaged("step out of range");
    for (auto& offsets : coding.offsets)
        for (std::uint8_t& offset : offsets)
            if ((offset = static_cast<std::uint8_t>(get(1))) > 31)
                return damaged("reconstruction offset out of range");
    for (std::uint8_t& weight : coding.scan_weights)
        if ((weight = static_cast<std::uint8_t>(get(1))) == 0)
            return damaged("scan weight 0");
    coding.correction_error = static_cast<std::uint16_t>(get(2));
    DifferenceModel model;
    for (std::uint8_t& parameter : model.parameter)
        if ((parameter = static_cast<std::uint8_t>(get(1))) >= parameter_count_of_odds)
            return damaged("difference model out of range");
    const unsigned flags = get(1);
    if (flags > 127)
        return damaged("unknown flags");
    coding.colour_rotation = (flags & 1) != 0;
    coding.prediction = (flags & 2) != 0;
    coding.dependent = (flags & 4) != 0;
    coding.smooth_copies = (flags & 8) != 0;
    if (coding.smooth_copies && !coding.prediction)
        return damaged("smooth copies without predictions");
    coding.base.on = (flags & 32) != 0;
    coding.base.v_against_u = (flags & 64) != 0;
    if (coding.base.on ? !coding.prediction : coding.base.v_against_u)
        return damaged("base pictures without predictions, or a direction without base pictures");
    if (coding.base.on) {
        if (bytes.size() <= at)
            return damaged("too short");
        coding.base.margin = static_cast<std::uint8_t>(get(1));
        if (coding.base.margin > max_base_margin)
            return damaged("margin of base pictures out of range");
    }
    if ((flags & 16) != 0) {
        if (bytes.size() < at + filter_bytes)
            return damaged("too short");
        for (auto& rings : coding.filter.ring)
            for (FilterRing& ring : rings) {
                ring.strength = static_cast<std::int8_t>(get(1));
                ring.reach = static_cast<std::uint8_t>(get(1));
                if (ring.strength == -128 || ring.reach == 0)
                    return damaged("filter out of range");
            }
        if (!coding.filter.is_on())
            return damaged("a filter that does nothing");
    }

    RansDecoder decoder(bytes.subspan(at));
    bool changed = false;
    for (std::size_t i = 0; i < coding.parameters.size(); ++i) {
        if (!holds(coding, i))
            continue;
        changed = decoder.bit(stop_frequency(model.parameter[changed ? after_change : after_same]));
        if (!changed)
            continue;
        int difference = 1;
        while (difference < parameter_count_of_odds - 1 &&
               decoder.bit(stop_frequency(model.parameter[more])))
            ++difference;
        const int value =
            default_parameters()[i] + (decoder.raw(1) != 0 ? -difference : difference);
        if (value < 0 || value >= parameter_count_of_odds)
            return damaged("table parameter out of range");
        coding.parameters[i] = static_cast<std::uint8_t>(value);
    }
    if (!decoder.ended_well())
        return damaged("tables do not end where they should");
    return coding;
}

Result<CodingParameters> with_coarser_steps(CodingParameters coding, unsigned step_shift) {
    const auto shift = [step_shift](StepCode& step) {
        const unsigned exponent = (step.bits >> 11) + step_shift;
        step.bits = static_cast<std::uint16_t>((exponent << 11) | (step.bits & 2047u));
        return exponent <= static_cast<unsigned>(max_step_exponent);
    };
    bool fits = shift(coding.rotated_step);
    for (StepCode& step : coding.step)
        fits = shift(step) && fits;
    if (!fits)
        return Status(ErrorCode::invalid_file, "a level's step shift of " +
                                                   std::to_string(step_shift) +
                                                   " raises a quantiser step above 2^20");
    return coding;
}

Status check_features(const CodingParameters& coding, std::uint64_t required_features) {
    const bool prediction = (required_features & feature_prediction) != 0;
    if (coding.prediction != prediction)
        return {ErrorCode::invalid_file,
                "section CODE and the header disagree about prediction (required feature 4)"};
    if (prediction && (required_features & feature_corrections) != 0)
        return {ErrorCode::invalid_file, "a file cannot have both prediction and corrections"};
    return {};
}

} // namespace tessera
