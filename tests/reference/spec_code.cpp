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
constexpr size_t parameter_count = 5809;
static_assert(std::size(default_parameter_list) == parameter_count);

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

Code read_code(Bytes section) {
    require(section.size() >= 24, "CODE: cut short");
    Code code;
    const auto read_step = [&](size_t at) {
        const uint16_t value = u16(section, at);
        require(value >> 11 <= 20, "CODE: step");
        return Step{value & 2047, value >> 11};
    };
    for (size_t p = 0; p < 4; ++p)
        code.step[p] = read_step(2 * p);
    code.rotated_step = read_step(8);
    for (size_t i = 0; i < 4; ++i) {
        const int offset = u8(section, 10 + i);
        require(offset <= 31, "CODE: reconstruction offset");
        code.offset[i / 2][i % 2] = offset;
    }
    for (size_t a = 0; a < 4; ++a) {
        code.scan_weight[a] = u8(section, 14 + a);
        require(code.scan_weight[a] >= 1, "CODE: scan weight");
    }
    code.correction_error = u16(section, 18);
    uint32_t d[3];
    for (size_t i = 0; i < 3; ++i) {
        require(u8(section, 20 + i) <= 63, "CODE: difference model");
        d[i] = frequency(u8(section, 20 + i));
    }
    const int flags = u8(section, 23);
    require(flags <= 127, "CODE: flags");
    code.has_colour_symbols = flags & 1;
    code.has_predictions = flags >> 1 & 1;
    code.dependent = flags & 4;
    code.smooth_copies = flags & 8;
    require(code.has_predictions || !code.smooth_copies, "CODE: flag 3 without flag 1");

    size_t at = 24;
    code.v_against_u = flags & 64;
    if (flags & 32) {
        require(section.size() > at, "CODE: cut short");
        code.base_margin = u8(section, at++);
        require(*code.base_margin <= 31, "CODE: margin");
    }
    require(code.has_predictions || !code.base_margin, "CODE: flag 5 without flag 1");
    require(code.base_margin || !code.v_against_u, "CODE: flag 6 without flag 5");
    if (flags & 16) {
        require(section.size() >= at + 12, "CODE: cut short");
        code.filter.emplace();
        bool does_something = false;
        for (auto& rings : *code.filter)
            for (Ring& ring : rings) {
                ring.strength = static_cast<int8_t>(u8(section, at++));
                ring.reach = u8(section, at++);
                require(ring.strength != -128 && ring.reach != 0, "CODE: filter");
                does_something = does_something || ring.strength != 0;
            }
        require(does_something, "CODE: a filter of strength 0");
    }

    // The differences from the default parameters.
    Stream stream(section.subspan(at));
    std::vector<int> parameters;
    bool differed = false;
    for (const int default_value : default_parameter_list) {
        int value = default_value;
        const size_t i = parameters.size();
        // The parameters of copying blocks: half of zero, magnitude and first_length, and all from
        // prediction to the end.
        const bool of_copies = (i >= 1344 && i < 2688) || (i >= 3876 && i < 5064) ||
                               (i >= 5181 && i < 5298) || i >= 5766;
        const bool of_bases = i >= 5798;
        if ((of_copies && !code.has_predictions) || (of_bases && !code.base_margin)) {
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
            t = table(2, 3);
    for (Table& t : code.correction)
        t = table(10, 25);
    for (Table& t : code.colour)
        t = table(2, 3);
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
    return code;
}

} // namespace tessera_reference::spec
