#include "corpus/picture/icc.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace tessera::corpus {
namespace {

constexpr std::size_t longest_profile_name = 60, most_tags = 200;
constexpr std::size_t tag_table = 128, tag_bytes = 12;

// All numbers are big-endian. Reads beyond the end give 0.
class Profile {
public:
    explicit Profile(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::uint32_t number(std::size_t at, std::size_t bytes) const {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value = value << 8 |
                    (at + i < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[at + i]) : 0u);
        return value;
    }
    double fixed(std::size_t at) const {
        return static_cast<std::int32_t>(number(at, 4)) / 65536.0;
    }
    bool has_text(std::size_t at, std::string_view text) const {
        for (std::size_t i = 0; i < text.size(); ++i)
            if (number(at + i, 1) != static_cast<unsigned char>(text[i]))
                return false;
        return true;
    }
    // Where a tag begins; 0 where there is none.
    std::size_t tag(std::string_view signature) const {
        const std::size_t count = std::min<std::size_t>(number(tag_table, 4), most_tags);
        for (std::size_t i = 0; i < count; ++i)
            if (const std::size_t entry = tag_table + 4 + i * tag_bytes; has_text(entry, signature))
                return number(entry + 4, 4);
        return 0;
    }
    std::string name() const {
        const std::size_t at = tag("desc");
        std::string text;
        const auto add = [&](std::uint32_t c) { text += c >= ' ' && c <= '~' ? char(c) : '?'; };
        if (has_text(at, "desc")) {
            const std::size_t length =
                std::min<std::size_t>(number(at + 8, 4), longest_profile_name);
            for (std::size_t i = 0; i < length && number(at + 12 + i, 1) != 0; ++i)
                add(number(at + 12 + i, 1));
        } else if (has_text(at, "mluc") && number(at + 8, 4) > 0) {
            const std::size_t length =
                std::min<std::size_t>(number(at + 20, 4) / 2, longest_profile_name);
            for (std::size_t i = 0; i < length; ++i)
                add(number(at + number(at + 24, 4) + 2 * i, 2));
        }
        return text;
    }

    // Whether the curve of a tag is that of sRGB or of gamma 2.2.
    bool is_usual_curve(std::string_view signature) const {
        const std::size_t at = tag(signature);
        if (at == 0)
            return false;
        double half = 0; // its value at 0.5
        const std::uint32_t count = number(at + 8, 4);
        if (has_text(at, "curv") && count == 0)
            half = 0.5;
        else if (has_text(at, "curv") && count == 1)
            half = std::pow(0.5, number(at + 12, 2) / 256.0);
        else if (has_text(at, "curv"))
            half = (number(at + 12 + 2 * std::size_t{(count - 1) / 2}, 2) +
                    number(at + 12 + 2 * std::size_t{count / 2}, 2)) /
                   2.0 / 65535;
        else if (has_text(at, "para") && number(at + 8, 2) == 0)
            half = std::pow(0.5, fixed(at + 12));
        else if (has_text(at, "para")) // (a x + b)^g
            half = std::pow(fixed(at + 16) * 0.5 + fixed(at + 20), fixed(at + 12));
        return std::abs(half - 0.214) < 0.01;
    }
    bool has_colour(std::string_view signature, double x, double y, double z) const {
        const std::size_t at = tag(signature);
        return at != 0 && std::abs(fixed(at + 8) - x) < 0.004 &&
               std::abs(fixed(at + 12) - y) < 0.004 && std::abs(fixed(at + 16) - z) < 0.004;
    }
    bool is_srgb() const {
        if (has_text(16, "GRAY"))
            return is_usual_curve("kTRC");
        return has_text(16, "RGB ") && has_colour("rXYZ", 0.4361, 0.2225, 0.0139) &&
               has_colour("gXYZ", 0.3851, 0.7169, 0.0971) &&
               has_colour("bXYZ", 0.1431, 0.0606, 0.7141) && is_usual_curve("rTRC");
    }

private:
    std::span<const std::byte> bytes_;
};

} // namespace

std::string icc_note(std::span<const std::byte> bytes, const std::string& otherwise) {
    const Profile profile(bytes);
    if (profile.is_srgb())
        return "";
    std::string name = profile.name();
    if (name.empty())
        name = otherwise.substr(0, longest_profile_name);
    return "the colour profile '" + name + "' is ignored, sRGB is assumed";
}

} // namespace tessera::corpus
