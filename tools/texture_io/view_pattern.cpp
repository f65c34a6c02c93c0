#include "tools/texture_io/view_pattern.h"

#include "tools/support/parse.h"
#include "tools/texture_io/picture_format.h"

#include <algorithm>
#include <cctype>

namespace tessera {
namespace {

constexpr std::size_t longest_pattern = 200;
constexpr std::size_t most_digits = 9;
constexpr std::size_t most_stars = 4;

char lower(char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

bool same_letters(std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, {}, lower, lower);
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

std::string digits_of(std::int64_t number, std::size_t width) {
    const std::string digits = std::to_string(number < 0 ? -number : number);
    return (number < 0 ? "-" : "") + std::string(width - std::min(width, digits.size()), '0') +
           digits;
}

using Item = ViewPattern::Item;

std::optional<std::int64_t>& field(ViewNumbers& numbers, Item::Kind kind) {
    return kind == Item::Kind::s ? numbers.s : kind == Item::Kind::t ? numbers.t : numbers.n;
}

// Matches a name by trying all lengths of stars and numbers. It remembers which items fail at which
// positions, so that it tries none of them twice.
class Matcher {
public:
    Matcher(const std::vector<Item>& items, std::size_t length)
        : items_(items), failed_((length + 1) * (items.size() + 1)) {}

    // Whether the items from `index` match all of `left`.
    bool match(std::size_t index, std::string_view left) {
        const std::size_t place = left.size() * (items_.size() + 1) + index;
        if (failed_[place])
            return false;
        failed_[place] = !try_item(index, left);
        return !failed_[place];
    }

    ViewNumbers numbers;

private:
    bool try_item(std::size_t index, std::string_view left) {
        if (index == items_.size())
            return left.empty();
        const Item& item = items_[index];
        if (item.kind == Item::Kind::literal)
            return same_letters(left.substr(0, item.text.size()), item.text) &&
                   match(index + 1, left.substr(item.text.size()));
        if (item.kind != Item::Kind::any)
            return try_number(index, left);
        for (std::size_t length = 0; length <= left.size(); ++length)
            if (match(index + 1, left.substr(length)))
                return true;
        return false;
    }

    bool try_number(std::size_t index, std::string_view left) {
        const Item& item = items_[index];
        const bool negative = left.starts_with('-');
        const std::string_view digits = left.substr(negative ? 1 : 0);
        const auto other = std::ranges::find_if_not(digits, is_digit);
        const auto found = static_cast<std::size_t>(other - digits.begin());
        const bool beside = is_number(index + 1) || (index > 0 && is_number(index - 1));
        const std::size_t least = beside ? item.width : 1, most = beside ? item.width : most_digits;
        for (std::size_t length = std::min(found, most); length >= least; --length) {
            std::uint64_t value = 0;
            parse_number(digits.substr(0, length), value);
            field(numbers, item.kind) =
                negative ? -static_cast<std::int64_t>(value) : static_cast<std::int64_t>(value);
            *field(numbers, item.kind) -= item.first;
            if (match(index + 1, digits.substr(length)))
                return true;
        }
        return false;
    }

    bool is_number(std::size_t item) const {
        return item < items_.size() && items_[item].kind != Item::Kind::literal &&
               items_[item].kind != Item::Kind::any;
    }

    const std::vector<Item>& items_;
    std::vector<bool> failed_; // by item and length of the rest
};

} // namespace

// Adds what {} encloses, such as "t:2".
Status ViewPattern::add_number(std::string_view inside) {
    Item item;
    const std::string_view letter = inside.substr(0, 1);
    item.kind = letter == "s" ? Item::Kind::s : letter == "t" ? Item::Kind::t : Item::Kind::n;
    std::uint64_t width = 1, first = 0;
    std::string_view rest = inside.substr(std::min<std::size_t>(1, inside.size()));
    bool is_valid = letter == "s" || letter == "t" || letter == "n";
    if (rest.starts_with(':')) {
        const std::size_t end = std::min(rest.find_first_of("+-"), rest.size());
        is_valid = is_valid && parse_number(rest.substr(1, end - 1), width) && width >= 1 &&
                   width <= most_digits;
        rest.remove_prefix(end);
    }
    if (!rest.empty()) {
        is_valid = is_valid && (rest[0] == '+' || rest[0] == '-') &&
                   rest.size() <= 1 + most_digits && parse_number(rest.substr(1), first);
        item.first = static_cast<std::int64_t>(first) * (rest[0] == '-' ? -1 : 1);
    }
    if (!is_valid)
        return {ErrorCode::bad_argument, "'{" + std::string(inside) +
                                             "}' is not {s}, {t} or {n}, or with digits {n:3}, or "
                                             "with the first number {n+1}"};
    for (const Item& other : items_)
        if (other.kind == item.kind)
            return {ErrorCode::bad_argument, "{" + std::string(letter) + "} occurs twice"};
    item.width = width;
    items_.push_back(std::move(item));
    return {};
}

Result<ViewPattern> ViewPattern::parse(const std::string& text) {
    const auto bad = [&](const std::string& why) {
        return Status(ErrorCode::bad_argument,
                      "the pattern '" + printable(text.substr(0, longest_pattern)) + "' " + why);
    };
    ViewPattern pattern;
    pattern.text_ = text;
    if (text.size() > longest_pattern)
        return bad("is too long");
    if (text.starts_with('.') ||
        std::ranges::any_of(text, [](char c) { return c == '/' || (c >= 0 && c < ' '); }))
        return bad("is not the name of a file in a folder");
    if (std::ranges::count(text, '*') > static_cast<std::ptrdiff_t>(most_stars))
        return bad("has more than " + std::to_string(most_stars) + " stars");
    for (std::string_view left = text; !left.empty();) {
        if (left[0] == '*') {
            pattern.items_.push_back({.kind = Item::Kind::any});
            left.remove_prefix(1);
        } else if (left[0] == '{') {
            const std::size_t end = left.find('}');
            if (end == std::string_view::npos)
                return bad("lacks a }");
            if (Status s = pattern.add_number(left.substr(1, end - 1)); !s.ok())
                return bad("is invalid: " + s.message());
            left.remove_prefix(end + 1);
        } else {
            const std::size_t end = std::min(left.find_first_of("*{"), left.size());
            pattern.items_.push_back({.text = std::string(left.substr(0, end))});
            left.remove_prefix(end);
        }
    }
    const auto has = [&](Item::Kind kind) {
        return std::ranges::any_of(pattern.items_, [&](const Item& i) { return i.kind == kind; });
    };
    pattern.running_ = has(Item::Kind::n);
    const bool placed = has(Item::Kind::s) || has(Item::Kind::t);
    if (pattern.running_ == placed)
        return bad("needs {t} and {s}, the row and the column, or {n}, one running number");
    if (picture_kind_of_name(text) == corpus::PictureKind::none)
        return bad(std::string("does not end in ") + picture_endings);
    return pattern;
}

std::optional<ViewNumbers> ViewPattern::match(std::string_view name) const {
    Matcher matcher(items_, name.size());
    return matcher.match(0, name) ? std::optional(matcher.numbers) : std::nullopt;
}

std::string ViewPattern::name_of(ViewNumbers numbers) const {
    std::string name;
    for (const Item& item : items_)
        if (item.kind == Item::Kind::literal)
            name += item.text;
        else if (item.kind != Item::Kind::any)
            name += digits_of(item.first + field(numbers, item.kind).value_or(0), item.width);
    return name;
}

void ViewPattern::begin_at(ViewNumbers first) {
    text_.clear();
    for (Item& item : items_) {
        if (item.kind == Item::Kind::literal) {
            text_ += item.text;
            continue;
        }
        if (item.kind == Item::Kind::any) {
            text_ += '*';
            continue;
        }
        item.first += field(first, item.kind).value_or(0);
        text_ += item.kind == Item::Kind::s ? "{s" : item.kind == Item::Kind::t ? "{t" : "{n";
        text_ += item.width > 1 ? ":" + std::to_string(item.width) : "";
        text_ += item.first > 0 ? "+" : "";
        text_ += item.first != 0 ? std::to_string(item.first) : "";
        text_ += '}';
    }
}

} // namespace tessera
