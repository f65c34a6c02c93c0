#include "tools/support/parse.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <vector>

namespace tessera {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t at = text.find(separator);
        parts.push_back(text.substr(0, at));
        if (at == std::string_view::npos)
            return parts;
        text.remove_prefix(at + 1);
    }
}

template <class Number> bool parse_whole(std::string_view text, Number& out) {
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, out);
    return error == std::errc() && rest == end;
}

bool parse_range(std::string_view text, std::uint32_t limit, std::uint32_t& begin,
                 std::uint32_t& end) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos)
        return false;
    const std::string_view low = text.substr(0, colon), high = text.substr(colon + 1);
    std::uint64_t first = 0, last = limit;
    if ((!low.empty() && !parse_number(low, first)) || (!high.empty() && !parse_number(high, last)))
        return false;
    begin = static_cast<std::uint32_t>(std::min<std::uint64_t>(first, UINT32_MAX));
    end = static_cast<std::uint32_t>(std::min<std::uint64_t>(last, UINT32_MAX));
    return true;
}

} // namespace

bool parse_number(std::string_view text, std::uint64_t& out) {
    return parse_whole(text, out);
}

bool parse_number(std::string_view text, double& out) {
    return parse_whole(text, out) && std::isfinite(out);
}

bool parse_numbers(std::string_view text, std::span<double> out) {
    const auto parts = split(text, ',');
    if (parts.size() != out.size())
        return false;
    for (std::size_t i = 0; i < out.size(); ++i)
        if (!parse_number(parts[i], out[i]))
            return false;
    return true;
}

Result<Extent4> parse_extent(std::string_view text) {
    const Status malformed(ErrorCode::bad_argument, "'" + std::string(text.substr(0, 100)) +
                                                        "' is not a size UxVxSxT such as "
                                                        "512x256x32x32");
    const auto parts = split(text, 'x');
    if (parts.size() != 4)
        return malformed;
    TextureDesc desc;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        std::uint64_t value = 0;
        if (!parse_number(parts[axis], value))
            return malformed;
        // Saturates; check_desc() refuses it with a better message.
        desc.size[axis] = static_cast<std::uint32_t>(std::min<std::uint64_t>(value, UINT32_MAX));
    }
    TESSERA_TRY(check_desc(desc));
    return desc.size;
}

Result<Extent4> parse_extent_or(const std::string& text, const char* option, const Extent4& usual) {
    if (text.empty())
        return usual;
    return parse_extent(text).with_context(option);
}

Result<Box4> parse_box(std::string_view text, const Extent4& whole) {
    const auto parts = split(text, ',');
    const std::string quoted = "'" + std::string(text.substr(0, 100)) + "'";
    if (parts.size() != 4)
        return Status(ErrorCode::bad_argument,
                      quoted + " is not a box u0:u1,v0:v1,s0:s1,t0:t1 such as 0:64,:,3:4,:");
    Box4 box;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        const std::string name(1, axis_name(static_cast<int>(axis)));
        if (!parse_range(parts[axis], whole[axis], box.begin[axis], box.end[axis]))
            return Status(ErrorCode::bad_argument, quoted + ": '" + std::string(parts[axis]) +
                                                       "' is not a range " + name + "0:" + name +
                                                       "1");
        if (box.begin[axis] >= box.end[axis] || box.end[axis] > whole[axis])
            return Status(ErrorCode::bad_argument,
                          quoted + ": the range of " + name +
                              " is empty or not inside 0:" + std::to_string(whole[axis]));
    }
    return box;
}

Result<SampleType> parse_sample_type(std::string_view text) {
    if (text == "8")
        return SampleType::unorm8;
    if (text == "16f" || text == "half")
        return SampleType::half16;
    std::string names;
    for (std::size_t i = 0; i < sample_types.size(); ++i) {
        if (text == sample_types[i].name)
            return static_cast<SampleType>(i);
        names += (i == 0 ? "" : ", ") + std::string(sample_types[i].name);
    }
    return Status(ErrorCode::bad_argument, "'" + std::string(text.substr(0, 100)) +
                                               "' is not a sample type (" + names + ")");
}

const char* name_of(SampleType type) {
    return traits_of(type).name;
}

std::string format_number(double value, int decimals) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    return text;
}

std::string format_digits(double value, int digits) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", std::min(digits, 17), value);
    return text;
}

Status parse_point(std::string_view text, glm::dvec3& out) {
    double xyz[3];
    if (!parse_numbers(text, xyz))
        return {ErrorCode::bad_argument,
                "'" + std::string(text) + "' is not a point such as 10,0,-2.5"};
    out = {xyz[0], xyz[1], xyz[2]};
    return {};
}

const char* channel_name(unsigned channels, unsigned c) {
    if (channels >= 3)
        return c == 0 ? "R" : c == 1 ? "G" : c == 2 ? "B" : "A";
    return c == 0 ? "Y" : "A";
}

// Replaces C0 and DEL; also C1 (U+0080 to U+009F), which is C2 80 to C2 9F in UTF-8. A terminal
// without UTF-8 treats the single bytes 80 to 9F as controls, too.
std::string printable(std::string text) {
    std::size_t inside = 0; // bytes that remain of a UTF-8 sequence
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const bool continues = c >= 0x80 && c < 0xC0;
        const bool is_c1 = continues && c < 0xA0 &&
                           (inside == 0 || static_cast<unsigned char>(text[i - 1]) == 0xC2);
        if (c < 0x20 || c == 0x7F || is_c1) {
            text[i] = ' ';
            if (is_c1 && inside > 0)
                text[i - 1] = ' ';
        }
        inside = continues ? inside - std::min<std::size_t>(inside, 1)
                           : (c >= 0xF0   ? 3
                              : c >= 0xE0 ? 2
                              : c >= 0xC0 ? 1
                                          : 0);
    }
    return text;
}

std::string human_bytes(std::uint64_t bytes) {
    const char* const units[] = {"kB", "MB", "GB", "TB", "PB"};
    if (bytes < 1000)
        return std::to_string(bytes) + " bytes";
    double value = static_cast<double>(bytes) / 1000;
    int unit = 0;
    for (; value >= 999.95 && unit < 4; ++unit)
        value /= 1000;
    return format_number(value, 1) + " " + units[unit];
}

} // namespace tessera
