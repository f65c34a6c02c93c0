// Names of pictures of views as a pattern: "cam_{t:2}_{s:2}.png", "input_Cam{n:3}.png".
#pragma once

#include "format/status.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// The numbers in a name: either n, or s or t or both.
struct ViewNumbers {
    std::optional<std::int64_t> s{}, t{}, n{};
};

// Text with {s} (the column), {t} (the row) or {n} (a running number), which stand for decimal
// digits. {n:3} is written with at least three digits; it matches any number of digits, but exactly
// three beside another number as in {t:2}{s:2}. * matches any text and is written as none. Letters
// match in either case. Numbers count from 0; {n+1} and {n:3+1} count from 1, {n-4} from -4.
class ViewPattern {
public:
    // Errors: bad_argument (malformed, without a number, an ending of no known kind of picture, or
    // a name outside of its folder).
    static Result<ViewPattern> parse(const std::string& text);

    const std::string& text() const { return text_; }
    bool is_running() const { return running_; } // by {n}
    std::optional<ViewNumbers> match(std::string_view name) const;
    // Precondition: `numbers` has those of the pattern.
    std::string name_of(ViewNumbers numbers) const;
    // From now on, match() gives 0 where it gave `first`. text() states that.
    void begin_at(ViewNumbers first);

    struct Item {
        enum class Kind { literal, any, s, t, n } kind = Kind::literal;
        std::string text{};     // of a literal
        std::size_t width = 1;  // of a number: digits
        std::int64_t first = 0; // of a number: what the name has for 0
    };

private:
    Status add_number(std::string_view inside);

    std::string text_;
    std::vector<Item> items_;
    bool running_ = false;
};

// The names that `decode` gives by default: "view_t003_s012.png".
inline constexpr const char* usual_view_pattern = "view_t{t:3}_s{s:3}.png";

} // namespace tessera
