#include "tools/support/option_checks.h"

#include "tools/support/parse.h"
#include "tools/support/suggestions.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

namespace tessera {
namespace {

constexpr std::uint64_t most_mebibytes = 1u << 20;

std::string in_quotes(const std::string& text) {
    return "'" + text.substr(0, 100) + "'";
}

// In the largest unit that is exact: "16G", "20000".
std::string size_text(std::uint64_t bytes) {
    const char* const units[] = {"", "k", "M", "G", "T"};
    int unit = 0;
    for (; bytes > 0 && bytes % 1024 == 0 && unit < 4; ++unit)
        bytes /= 1024;
    return std::to_string(bytes) + units[unit];
}

// The shortest text that gives the same number: "0.001", "1e-06".
std::string plain(double value) {
    char text[40];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string_view leading_digits(std::string_view text) {
    return text.substr(0, std::min(text.find_first_not_of("0123456789"), text.size()));
}

} // namespace

Result<std::uint64_t> parse_size(const std::string& text) {
    const Status malformed(ErrorCode::bad_argument,
                           in_quotes(text) + " is not a size such as 20000, 512M or 1.5GiB");
    const std::string_view digits = leading_digits(text);
    std::uint64_t value = 0;
    if (!parse_number(digits, value))
        return malformed;
    std::string unit = text.substr(digits.size());
    double fraction = 0; // of a unit
    if (unit.starts_with('.')) {
        const std::string_view after = leading_digits(std::string_view(unit).substr(1));
        if (after.empty() || !parse_number("0." + std::string(after), fraction))
            return malformed;
        unit = unit.substr(1 + after.size());
        if (unit.empty() || std::tolower(static_cast<unsigned char>(unit[0])) == 'b')
            return malformed; // a byte has no parts
    }
    for (char& c : unit)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (unit.empty() || unit == "b")
        return value;
    const std::size_t power = std::string_view("kmgt").find(unit[0]);
    const std::string rest = unit.substr(1);
    if (power == std::string_view::npos || (rest != "" && rest != "b" && rest != "ib"))
        return malformed;
    const unsigned shift = 10 * (static_cast<unsigned>(power) + 1);
    if (value >> (63 - shift) != 0)
        return malformed;
    const double below = std::ldexp(fraction, static_cast<int>(shift));
    return (value << shift) + static_cast<std::uint64_t>(below);
}

CLI::Validator number_between(double low, double high) {
    return {[low, high](std::string& text) {
                double value = 0;
                return parse_number(text, value) && value >= low && value <= high
                           ? std::string()
                           : in_quotes(text) + " is not a number from " + plain(low) + " to " +
                                 plain(high);
            },
            "in " + plain(low) + ".." + plain(high)};
}

CLI::Validator one_of(std::vector<std::string> words) {
    std::string all;
    for (const std::string& word : words)
        all += (all.empty() ? "" : ", ") + word;
    return {[words = std::move(words), all](std::string& text) {
                return std::ranges::count(words, text) > 0
                           ? std::string()
                           : in_quotes(text) + " is not one of: " + all + did_you_mean(text, words);
            },
            "{" + all + "}"};
}

CLI::Validator size_between(std::uint64_t low, std::uint64_t high) {
    return {[low, high](std::string& text) {
                const auto size = parse_size(text);
                if (!size.ok())
                    return size.status().message();
                if (*size < low || *size > high)
                    return in_quotes(text) + " is not a size from " + size_text(low) + " to " +
                           size_text(high) + " bytes";
                text = std::to_string(*size);
                return std::string();
            },
            ""};
}

CLI::Validator size_in_mebibytes() {
    return {[](std::string& text) {
                const auto size = parse_size(text);
                const std::uint64_t whole = size.ok() ? (*size + (1u << 20) - 1) >> 20 : 0;
                if (!size.ok() || *size < (1u << 20) || whole > most_mebibytes)
                    return in_quotes(text) + " is not a size from 1M to 1T such as 512M or 2G";
                text = std::to_string(whole);
                return std::string();
            },
            ""};
}

} // namespace tessera
