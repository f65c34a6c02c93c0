#include "format/tile/coding_parameters.h"

#include "format/io/bytes.h"
#include "format/tile/features.h"

#include <cmath>
#include <cstdlib>

namespace tessera {
namespace {

// The flags of section CODE.
constexpr unsigned rotation_flag = 1, prediction_flag = 2, dependent_flag = 4, smooth_flag = 8,
                   filter_flag = 16, base_flag = 32, v_against_u_flag = 64, weights_flag = 128,
                   differences_flag = 256, pictures_flag = 512, no_transform_flag = 1024,
                   any_plane_flag = 2048, plane_trees_flag = 4096, known_flags = 8191;

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
    return (coding.prediction || !is_of_copies(i)) && (coding.base.on || !is_of_bases(i)) &&
           (coding.leaves_out_transforms || i < no_transform_offset);
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
        const int difference = parameters[i] - default_parameters(coding.defaults)[i];
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

std::vector<std::byte> write_coding_parameters(const CodingParameters& coding, int planes,
                                               bool corrections) {
    std::array<double, 3> stops{}, goes{};
    walk(
        coding, [&](std::size_t which, bool go) { (go ? goes : stops)[which] += 1.0; },
        [](bool) {});
    const bool differs = goes[after_same] > 0; // the first difference comes after none
    const bool weights = coding.scan_weights != default_scan_weights;

    std::vector<std::byte> out;
    const auto put = [&out](unsigned value, int bytes) {
        for (int i = 0; i < bytes; ++i)
            out.push_back(static_cast<std::byte>(value >> (8 * i) & 255));
    };
    put((coding.colour_rotation ? rotation_flag : 0) | (coding.prediction ? prediction_flag : 0) |
            (coding.dependent ? dependent_flag : 0) | (coding.smooth_copies ? smooth_flag : 0) |
            (coding.filter.is_on() ? filter_flag : 0) | (coding.base.on ? base_flag : 0) |
            (coding.base.v_against_u ? v_against_u_flag : 0) | (weights ? weights_flag : 0) |
            (differs ? differences_flag : 0) |
            (coding.defaults == DefaultSet::pictures ? pictures_flag : 0) |
            (coding.leaves_out_transforms ? no_transform_flag : 0) |
            (coding.transforms_any_plane ? any_plane_flag : 0) |
            (coding.plane_trees ? plane_trees_flag : 0),
        2);
    for (int plane = 0; plane < planes; ++plane)
        put(coding.step[static_cast<std::size_t>(plane)].bits, 2);
    if (coding.colour_rotation)
        put(coding.rotated_step.bits, 2);
    for (const auto& offsets : std::span(coding.offsets).first(planes > 1 ? 2 : 1))
        for (const std::uint8_t offset : offsets)
            put(offset, 1);
    if (weights)
        for (const std::uint8_t weight : coding.scan_weights)
            put(weight, 1);
    if (corrections)
        put(coding.correction_error, 2);
    if (coding.base.on)
        put(coding.base.margin, 1);
    if (coding.filter.is_on())
        for (const auto& rings : coding.filter.ring)
            for (const FilterRing& ring : rings) {
                put(static_cast<std::uint8_t>(ring.strength), 1);
                put(ring.reach, 1);
            }
    if (!differs)
        return out;

    DifferenceModel model;
    for (std::size_t i = 0; i < model.parameter.size(); ++i)
        put(model.parameter[i] = fit(stops[i], goes[i]), 1);
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

namespace {

Status bad_section(const char* what) {
    return {ErrorCode::invalid_file, std::string("section CODE: ") + what};
}

// Takes fields from the start of a section. A field that is not there is 0 and sets cut_off().
class CodeReader {
public:
    explicit CodeReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::uint8_t u8() {
        if (bytes_.empty()) {
            cut_off_ = true;
            return 0;
        }
        const auto value = std::to_integer<std::uint8_t>(bytes_.front());
        bytes_ = bytes_.subspan(1);
        return value;
    }
    std::uint16_t u16() {
        const unsigned low = u8();
        return static_cast<std::uint16_t>(low | unsigned{u8()} << 8);
    }
    bool cut_off() const { return cut_off_; }
    std::span<const std::byte> rest() const { return bytes_; }

private:
    std::span<const std::byte> bytes_;
    bool cut_off_ = false;
};

Status read_flags(unsigned flags, int planes, CodingParameters& coding) {
    if ((flags & ~known_flags) != 0)
        return bad_section("unknown flags");
    coding.colour_rotation = (flags & rotation_flag) != 0;
    coding.prediction = (flags & prediction_flag) != 0;
    coding.dependent = (flags & dependent_flag) != 0;
    coding.smooth_copies = (flags & smooth_flag) != 0;
    coding.use_defaults((flags & pictures_flag) != 0 ? DefaultSet::pictures : DefaultSet::views);
    if (coding.smooth_copies && !coding.prediction)
        return bad_section("smooth copies without predictions");
    coding.leaves_out_transforms = (flags & no_transform_flag) != 0;
    if (coding.leaves_out_transforms && !coding.prediction)
        return bad_section("axes without a transform, but no predictions");
    coding.transforms_any_plane = (flags & any_plane_flag) != 0;
    if (coding.transforms_any_plane && !coding.prediction)
        return bad_section("transforms of blocks without a first plane, but no predictions");
    coding.plane_trees = (flags & plane_trees_flag) != 0;
    if (coding.plane_trees && (!coding.prediction || planes != 2))
        return bad_section("a split tree for each plane, but no predictions or not two planes");
    coding.base.on = (flags & base_flag) != 0;
    coding.base.v_against_u = (flags & v_against_u_flag) != 0;
    if (coding.base.on ? !coding.prediction : coding.base.v_against_u)
        return bad_section(
            "base pictures without predictions, or a direction without base pictures");
    return {};
}

Status read_steps_and_offsets(CodeReader& in, int planes, CodingParameters& coding) {
    bool fits = true;
    const auto read_step = [&](StepCode& step) {
        step.bits = in.u16();
        fits = fits && (step.bits >> 11) <= max_step_exponent;
    };
    for (int plane = 0; plane < planes; ++plane)
        read_step(coding.step[static_cast<std::size_t>(plane)]);
    if (coding.colour_rotation)
        read_step(coding.rotated_step);
    if (!fits)
        return bad_section("step out of range");
    for (auto& offsets : std::span(coding.offsets).first(planes > 1 ? 2 : 1))
        for (std::uint8_t& offset : offsets)
            if ((offset = in.u8()) > 31)
                return bad_section("reconstruction offset out of range");
    return {};
}

Status read_filter(CodeReader& in, TileFilter& filter) {
    for (auto& rings : filter.ring)
        for (FilterRing& ring : rings) {
            ring.strength = static_cast<std::int8_t>(in.u8());
            ring.reach = in.u8();
            if (!in.cut_off() && (ring.strength == -128 || ring.reach == 0))
                return bad_section("filter out of range");
        }
    return in.cut_off() || filter.is_on() ? Status() : bad_section("a filter that does nothing");
}

Status read_differences(CodeReader& in, CodingParameters& coding) {
    DifferenceModel model;
    for (std::uint8_t& parameter : model.parameter)
        if ((parameter = in.u8()) >= parameter_count_of_odds)
            return bad_section("difference model out of range");
    if (in.cut_off())
        return bad_section("too short");
    RansDecoder decoder(in.rest());
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
        const int value = default_parameters(coding.defaults)[i] +
                          (decoder.raw(1) != 0 ? -difference : difference);
        if (value < 0 || value >= parameter_count_of_odds)
            return bad_section("table parameter out of range");
        coding.parameters[i] = static_cast<std::uint8_t>(value);
    }
    return decoder.ended_well() ? Status() : bad_section("tables do not end where they should");
}

} // namespace

Result<CodingParameters> read_coding_parameters(std::span<const std::byte> bytes, int planes,
                                                bool corrections) {
    CodeReader in(bytes);
    CodingParameters coding;
    const unsigned flags = in.u16();
    TESSERA_TRY(read_flags(flags, planes, coding));
    TESSERA_TRY(read_steps_and_offsets(in, planes, coding));
    if ((flags & weights_flag) != 0)
        for (std::uint8_t& weight : coding.scan_weights)
            if ((weight = in.u8()) == 0 && !in.cut_off())
                return bad_section("scan weight 0");
    if (corrections)
        coding.correction_error = in.u16();
    if (coding.base.on && (coding.base.margin = in.u8()) > max_base_margin)
        return bad_section("margin of base pictures out of range");
    if ((flags & filter_flag) != 0)
        TESSERA_TRY(read_filter(in, coding.filter));
    if (in.cut_off())
        return bad_section("too short");
    if ((flags & differences_flag) != 0)
        TESSERA_TRY(read_differences(in, coding));
    else if (!in.rest().empty())
        return bad_section("bytes after the last field");
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

std::uint64_t features_of(const CodingParameters& coding) {
    return (coding.prediction ? feature_prediction : 0) |
           (coding.leaves_out_transforms ? feature_no_transform : 0) |
           (coding.transforms_any_plane ? feature_any_plane : 0) |
           (coding.plane_trees ? feature_plane_trees : 0);
}

Status check_features(const CodingParameters& coding, std::uint64_t required_features) {
    const std::uint64_t differs = features_of(coding) ^ required_features;
    if ((differs & feature_prediction) != 0)
        return {ErrorCode::invalid_file,
                "section CODE and the header disagree about prediction (required feature 4)"};
    if ((differs & feature_no_transform) != 0)
        return {ErrorCode::invalid_file, "section CODE and the header disagree about axes without "
                                         "a transform (required feature 8)"};
    if ((differs & feature_any_plane) != 0)
        return {ErrorCode::invalid_file, "section CODE and the header disagree about transforms of "
                                         "blocks without a first plane (required feature 9)"};
    if ((differs & feature_plane_trees) != 0)
        return {ErrorCode::invalid_file, "section CODE and the header disagree about a split tree "
                                         "for each plane (required feature 10)"};
    if (coding.prediction && (required_features & feature_corrections) != 0)
        return {ErrorCode::invalid_file, "a file cannot have both prediction and corrections"};
    return {};
}

} // namespace tessera
