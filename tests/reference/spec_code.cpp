#include "tests/reference/spec_code.h"

#include "tests/reference/spec_decoder.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tessera_reference::spec {

namespace {

constexpr uint8_t default_parameter_list[] = {
#include "format/tables/default_parameters.inc"
};
constexpr uint8_t picture_parameter_list[] = {
#include "format/tables/picture_parameters.inc"
};
constexpr size_t parameter_count = 6019;
static_assert(std::size(default_parameter_list) == parameter_count);
static_assert(std::size(picture_parameter_list) == parameter_count);

uint32_t frequency(int p) {
    const double exact = 4096 / (1 + std::exp2((p - 32) / 3.0));
    return static_cast<uint32_t>(std::clamp(std::lround(exact), 1l, 4095l));
}

// Computes a table of m symbols from its chain of parameters.
Table make_table(std::span<const int> chain, int m) {
    Table c;
    int s = 0;
    for (int i = 0; i <= m - 2; ++i) {
        c.push_back(static_cast<uint32_t>(s));
        const int left = 4096 - s;
        const int p = chain[std::min(static_cast<size_t>(i), chain.size() - 1)];
        const int share = left * static_cast<int>(frequency(p)) / 4096;
        s += std::clamp(share, 1, left - (m - 1 - i));
    }
    c.push_back(static_cast<uint32_t>(s));
    c.push_back(4096);
    return c;
}

} // namespace

Code read_code(Bytes section, const Header& header) {
    size_t at = 0;
    const auto next_u8 = [&] {
        require(at < section.size(), "CODE: cut short");
        return u8(section, at++);
    };
    const auto next_u16 = [&] {
        const int low = next_u8();
        return low | next_u8() << 8;
    };
    const auto next_step = [&] {
        const int value = next_u16();
        require(value >> 11 <= 20, "CODE: step");
        return Step{value & 2047, value >> 11};
    };
    Code code;
    const int flags = next_u16();
    require(flags <= 8191, "CODE: flags");
    code.has_colour_symbols = flags & 1;
    code.has_predictions = flags >> 1 & 1;
    code.leaves_out_transforms = flags & 1024;
    code.transforms_any_plane = flags & 2048;
    code.has_plane_trees = flags & 4096;
    code.dependent = flags & 4;
    code.smooth_copies = flags & 8;
    code.v_against_u = flags & 64;
    require(code.has_predictions || !code.smooth_copies, "CODE: flag 3 without flag 1");
    require(code.has_predictions || !(flags & 32), "CODE: flag 5 without flag 1");
    require(code.has_predictions || !code.leaves_out_transforms, "CODE: flag 10 without flag 1");
    require(code.has_predictions || !code.transforms_any_plane, "CODE: flag 11 without flag 1");
    require((flags & 32) || !code.v_against_u, "CODE: flag 6 without flag 5");
    require((code.has_predictions && header.channels == 2) || !code.has_plane_trees,
            "CODE: flag 12 without flag 1 or two channels");

    for (int plane = 0; plane < header.channels; ++plane)
        code.step[static_cast<size_t>(plane)] = next_step();
    if (flags & 1)
        code.rotated_step = next_step();
    for (size_t i = 0; i < (header.channels > 1 ? 4u : 2u); ++i) {
        code.offset[i / 2][i % 2] = next_u8();
        require(code.offset[i / 2][i % 2] <= 31, "CODE: reconstruction offset");
    }
    if (flags & 128)
        for (int& weight : code.scan_weight) {
            weight = next_u8();
            require(weight >= 1, "CODE: scan weight");
        }
    if (header.has_corrections())
        code.correction_error = next_u16();
    if (flags & 32) {
        code.base_margin = next_u8();
        require(*code.base_margin <= 31, "CODE: margin");
    }
    if (flags & 16) {
        code.filter.emplace();
        bool does_something = false;
        for (auto& rings : *code.filter)
            for (Ring& ring : rings) {
                ring.strength = static_cast<int8_t>(next_u8());
                ring.reach = next_u8();
                require(ring.strength != -128 && ring.reach != 0, "CODE: filter");
                does_something = does_something || ring.strength != 0;
            }
        require(does_something, "CODE: a filter of strength 0");
    }
    const bool has_differences = flags & 256;
    uint32_t d[3] = {4096, 4096, 4096};
    if (has_differences)
        for (uint32_t& frequency_of_0 : d) {
            const int p = next_u8();
            require(p <= 63, "CODE: difference model");
            frequency_of_0 = frequency(p);
        }
    else
        require(at == section.size(), "CODE: bytes after the last field");

    // The differences from the default parameters.
    Stream stream(section.subspan(at));
    std::vector<int> parameters;
    bool differed = false;
    for (const int default_value : flags & 512 ? picture_parameter_list : default_parameter_list) {
        int value = default_value;
        const size_t i = parameters.size();
        // The parameters of predictions: half of zero, magnitude and first_length, and all from
        // prediction to the end. base, from_base and base_displacement are among them.
        const bool of_predictions = (i >= 1344 && i < 2688) || (i >= 3876 && i < 5064) ||
                                    (i >= 5181 && i < 5298) || i >= 5859;
        const bool of_bases = i >= 5891 && i < 5902;
        const bool of_no_transform = i >= 5983;
        if (!has_differences || (of_predictions && !code.has_predictions) ||
            (of_bases && !code.base_margin) || (of_no_transform && !code.leaves_out_transforms)) {
            parameters.push_back(value);
            continue;
        }
        differed = stream.bit(differed ? d[1] : d[0]);
        if (differed) {
            int difference = 1;
            while (difference < 63 && stream.bit(d[2]))
                ++difference;
            value += stream.raw(1) ? -difference : difference;
            require(value >= 0 && value <= 63, "CODE: parameter");
        }
        parameters.push_back(value);
    }
    require(stream.ends_well(), "CODE: the stream must end well");

    // The tables follow in the order of the parameters.
    std::span<const int> rest = parameters;
    const auto table = [&](size_t chain, int symbols) {
        const Table result = make_table(rest.first(chain), symbols);
        rest = rest.subspan(chain);
        return result;
    };
    for (auto& of_copies : code.zero)
        for (auto& quantiser : of_copies)
            for (auto& row : quantiser)
                for (auto& position : row)
                    for (uint32_t& f : position) {
                        f = frequency(rest[0]);
                        rest = rest.subspan(1);
                    }
    for (auto& of_copies : code.magnitude)
        for (auto& of_quantiser : of_copies)
            for (Table& t : of_quantiser)
                t = table(9, 24);
    for (Table& t : code.first_length)
        t = table(13, 14);
    for (Table& t : code.other_length)
        t = table(13, 14);
    for (auto& of_depth : code.split)
        for (Table& t : of_depth)
            t = table(4, 5);
    for (Table& t : code.correction)
        t = table(10, 25);
    for (Table& t : code.colour)
        t = table(3, 4);
    for (Table& t : code.share)
        t = table(8, 9);
    for (Table& t : code.prediction)
        t = table(2, 3);
    for (Table& t : code.displacement_kind)
        t = table(2, 3);
    for (Table& t : code.displacement)
        t = table(8, 9);
    code.base = table(1, 2);
    for (Table& t : code.from_base)
        t = table(1, 2);
    code.base_displacement = table(8, 9);
    for (Table& t : code.mode)
        t = table(5, 6);
    // The chains of transform symbols come from two arrays.
    const std::span<const int> no_transform = rest.subspan(size_t{3} * 12);
    for (size_t i = 0; i < 12; ++i) {
        std::vector<int> chain(&rest[3 * i], &rest[3 * i] + 3);
        if (code.leaves_out_transforms)
            chain.insert(chain.end(), &no_transform[3 * i], &no_transform[3 * i] + 3);
        code.transform[i] = make_table(chain, static_cast<int>(chain.size()) + 1);
    }
    return code;
}

} // namespace tessera_reference::spec
