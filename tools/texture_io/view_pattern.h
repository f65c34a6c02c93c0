// Names of pictures of views as a pattern: "cam_{t:2}_{s:2}.png", "input_Cam{n:3}.png".
#pragma once

#include "format/status.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// What a name says. Either n, or at least one of the others.
struct ViewNumbers {
    std::optional<std::int64_t> s, t, n;
};

// Text with {s} (the column), {t} (the row) or {n} (one running number) in it, as decimal digits. Of
// {n:3} at least three are written; read are any, and just three beside another number: {t:2}{s:2}.
// * is any text, and is written as none. Letters match in either case.
class ViewPattern {
public:
    // Errors: bad_argument, where it is malformed, says no number, ends in no known kind of picture,
    // or would leave its folder.
    static Result<ViewPattern> parse(const std::string& text);

    const std::string& text() const { return text_; }
    bool is_running() const { return running_; } // by {n}
    std::optional<ViewNumbers> match(std::string_view name) const;
    // Precondition: has the numbers that the pattern has.
    std::string name_of(const ViewNumbers& numbers) const;

private:
    struct Item {
        enum class Kind { literal, any, s, t, n } kind = Kind::literal;
        std::string text;      // of a literal
        std::size_t width = 1; // of a number
    };
    Status add_number(std::string_view inside);
    bool is_number(std::size_t item) const;
    // failed: by item and length of `left`, what was tried in vain.
    bool match_from(std::size_t item, std::string_view left, ViewNumbers& numbers,
                    std::vector<bool>& failed) const;
    bool try_from(std::size_t item, std::string_view left, ViewNumbers& numbers,
                  std::vector<bool>& failed) const;
    static std::optional<std::int64_t>& field(ViewNumbers& numbers, Item::Kind kind);

    std::string text_;
    std::vector<Item> items_;
    bool running_ = false;
};

// As `decode` names views: "view_t003_s012.png".
inline constexpr const char* usual_view_pattern = "view_t{t:3}_s{s:3}.png";

// Whether the ending is that of a picture that can be read: .png, .jpg, .jpeg, .exr, in either case.
bool has_picture_ending(std::string_view name);

} // namespace tessera
