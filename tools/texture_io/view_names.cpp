#include "tools/texture_io/view_names.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace tessera {
namespace {

constexpr std::size_t most_groups_named = 3; // in a message

bool is_digit_of_name(char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

// A name split at its numbers: texts[0] numbers[0] texts[1] ... numbers[k - 1] texts[k]. A minus
// belongs to the number behind it unless a letter or digit precedes it, as in "cam-01-02".
struct CutName {
    std::vector<std::string> texts{""}, numbers;
};

CutName cut_at_numbers(const std::string& name) {
    CutName cut;
    const std::size_t end = name.rfind('.'); // an ending has no numbers
    std::size_t i = 0;
    while (i < end) {
        const bool sign = name[i] == '-' && i + 1 < end && is_digit_of_name(name[i + 1]) && i > 0 &&
                          !std::isalnum(static_cast<unsigned char>(name[i - 1]));
        if (!sign && !is_digit_of_name(name[i])) {
            cut.texts.back() += name[i++];
            continue;
        }
        std::size_t last = i + (sign ? 1 : 0);
        while (last < end && is_digit_of_name(name[last]))
            ++last;
        if (last + 1 < end && name[last] == '.' && is_digit_of_name(name[last + 1])) {
            ++last;
            while (last < end && is_digit_of_name(name[last]))
                ++last;
        }
        cut.numbers.push_back(name.substr(i, last - i));
        cut.texts.emplace_back();
        i = last;
    }
    cut.texts.back() += name.substr(end);
    return cut;
}

// A key that names of one kind share: the texts in small letters, # for each number.
std::string kind_of_name(const CutName& cut) {
    std::string key;
    for (const std::string& text : cut.texts)
        for (const char c : text + "#")
            key += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return key;
}

// What the numbers at one position of the names have in common.
struct Field {
    bool whole = true; // no decimal point, and at most 9 digits
    bool varies = false;
    bool same_width = true;
    std::size_t width = 0;
};

Field field_of(const std::vector<CutName>& names, std::size_t index) {
    Field field;
    field.width = names.front().numbers[index].size();
    for (const CutName& name : names) {
        const std::string& number = name.numbers[index];
        field.whole = field.whole && number.find('.') == std::string::npos && number.size() <= 9;
        field.varies = field.varies || number != names.front().numbers[index];
        field.same_width = field.same_width && number.size() == field.width;
    }
    return field;
}

// Text of a name as text of a pattern, where braces have a meaning.
std::string as_pattern(std::string text) {
    std::ranges::replace_if(
        text, [](char c) { return c == '{' || c == '}'; }, '*');
    return text;
}

enum class NameAxis { unknown, column, row };

// What the letters in front of a number say.
NameAxis axis_before_number(const std::string& text) {
    std::size_t begin = text.size();
    while (begin > 0 && std::isalpha(static_cast<unsigned char>(text[begin - 1])) != 0)
        --begin;
    std::string word = text.substr(begin);
    std::ranges::transform(word, word.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* column : {"x", "u", "s", "c", "col", "column"})
        if (word == column)
            return NameAxis::column;
    for (const char* row : {"y", "v", "t", "r", "row"})
        if (word == row)
            return NameAxis::row;
    return NameAxis::unknown;
}

// Whether letters say that the first of two numbers is the column; nothing where they do not say it.
std::optional<bool> column_is_first(const CutName& name, const std::vector<Field>& fields) {
    std::vector<NameAxis> axes;
    for (std::size_t i = 0; i < fields.size(); ++i)
        if (fields[i].whole && fields[i].varies)
            axes.push_back(axis_before_number(name.texts[i]));
    if (axes.size() != 2 || axes[0] == axes[1] || axes[0] == NameAxis::unknown ||
        axes[1] == NameAxis::unknown)
        return std::nullopt;
    return axes[0] == NameAxis::column;
}

bool letters_tell_axes(const std::string& first, const std::string& last) {
    const std::vector<CutName> names{cut_at_numbers(first), cut_at_numbers(last)};
    std::vector<Field> fields;
    for (std::size_t i = 0; i < std::min(names[0].numbers.size(), names[1].numbers.size()); ++i)
        fields.push_back(field_of(names, i));
    return column_is_first(names[0], fields).has_value();
}

Result<std::string> pattern_of(const std::vector<CutName>& names, const ViewOrder& order) {
    const CutName& first = names.front();
    std::vector<Field> fields;
    std::size_t places = 0;
    for (std::size_t i = 0; i < first.numbers.size(); ++i) {
        fields.push_back(field_of(names, i));
        places += fields.back().whole && fields.back().varies ? 1 : 0;
    }
    if (places > 2)
        return Status(ErrorCode::bad_argument,
                      std::to_string(places) +
                          " numbers differ from name to name, and a view has a row and a column; "
                          "say --views-pattern, such as 'x{s}_y{t}_*.png'");
    const bool columns = order.columns || column_is_first(first, fields).value_or(false);
    const char* letters[2] = {places == 1 ? "n" : columns ? "s" : "t", columns ? "t" : "s"};
    std::string text = as_pattern(first.texts[0]);
    for (std::size_t i = 0, place = 0; i < fields.size(); ++i) {
        // The last number of a single picture is its running number.
        const bool only = places == 0 && names.size() == 1 && i + 1 == fields.size();
        if (fields[i].whole && (fields[i].varies || only)) {
            text += std::string("{") + (only ? "n" : letters[place++]);
            text += fields[i].same_width && fields[i].width > 1
                        ? ":" + std::to_string(fields[i].width) + "}"
                        : "}";
        } else {
            text += fields[i].varies ? "*" : first.numbers[i];
        }
        text += as_pattern(first.texts[i + 1]);
    }
    return text;
}

std::string example(const std::vector<std::string>& names) {
    return names.front() +
           (names.size() > 1 ? " (" + std::to_string(names.size()) + " like it)" : "");
}

// Names of the same kind, by their key.
using NameKinds = std::map<std::string, std::vector<std::string>>;

// The only kind that has several names, or the only kind.
Result<std::vector<std::string>> only_series(const NameKinds& kinds) {
    std::vector<const std::vector<std::string>*> series;
    for (const auto& [key, members] : kinds)
        if (members.size() > 1 || kinds.size() == 1)
            series.push_back(&members);
    if (series.size() == 1)
        return *series.front();
    std::string examples;
    std::size_t named = 0;
    for (const auto& [key, members] : kinds)
        if ((series.empty() || members.size() > 1) && named++ <= most_groups_named)
            examples += (examples.empty() ? "" : ", ") + example(members);
    return Status(ErrorCode::bad_argument,
                  (series.empty() ? "the names have nothing in common: "
                                  : "the names fit more than one pattern: ") +
                      examples + "; say which are views by --views-pattern, such as 'x{n}.png'");
}

// Where numbers begin that are to fit `size`: at 0 if they fit then, else at the smallest.
std::int64_t beginning(std::int64_t least, std::int64_t most, std::uint64_t size) {
    return least >= 0 && static_cast<std::uint64_t>(most) < size ? 0 : least;
}

struct Range {
    std::int64_t least = 0, most = 0;
    std::uint64_t size() const { return static_cast<std::uint64_t>(most - least) + 1; }
};

using Numbered = std::vector<std::pair<ViewNumbers, std::string>>;

Range range_of(const Numbered& views, std::optional<std::int64_t> ViewNumbers::*field) {
    Range range{(views.front().first.*field).value_or(0), 0};
    range.most = range.least;
    for (const auto& [numbers, name] : views) {
        const std::int64_t number = (numbers.*field).value_or(0);
        range.least = std::min(range.least, number);
        range.most = std::max(range.most, number);
    }
    return range;
}

std::uint32_t square_side(std::uint64_t count) {
    const auto side =
        static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(count))));
    return std::uint64_t{side} * side == count ? side : 0;
}

// A grid, and the numbers of the name at its first position.
struct Counted {
    ViewGrid grid;
    ViewNumbers first;
};

Result<Counted> count_running(const Numbered& views, const std::optional<ViewGrid>& known) {
    const Range range = range_of(views, &ViewNumbers::n);
    Counted counted;
    if (known) {
        counted.grid = *known;
    } else if (const std::uint32_t side = square_side(range.size())) {
        counted.grid = {side, side};
    } else if (const std::uint32_t of_count = square_side(views.size())) {
        counted.grid = {of_count, of_count};
    } else {
        return Status(ErrorCode::bad_argument,
                      views.front().second + " and " + std::to_string(views.size() - 1) +
                          " more have one running number, " + std::to_string(range.least) + " to " +
                          std::to_string(range.most) +
                          ", which is no square of views; say --grid, such as --grid " +
                          std::to_string(views.size()) + "x1");
    }
    counted.first.n = beginning(range.least, range.most, counted.grid.count());
    return counted;
}

Result<Counted> count_placed(const Numbered& views, const std::optional<ViewGrid>& known,
                             bool from_zero) {
    const Range s = range_of(views, &ViewNumbers::s), t = range_of(views, &ViewNumbers::t);
    const auto side = [&](const Range& range) {
        return from_zero && range.least >= 0 ? static_cast<std::uint64_t>(range.most) + 1
                                             : range.size();
    };
    Counted counted;
    if (known)
        counted.grid = *known;
    else if (side(s) > max_extent || side(t) > max_extent)
        return Status(ErrorCode::invalid_file,
                      views.front().second + " and the others: their numbers are " +
                          std::to_string(std::max(s.size(), t.size())) + " apart");
    else
        counted.grid = {static_cast<std::uint32_t>(side(s)), static_cast<std::uint32_t>(side(t))};
    counted.first.s = beginning(s.least, s.most, counted.grid.s);
    counted.first.t = beginning(t.least, t.most, counted.grid.t);
    return counted;
}

// The position of the view with these numbers; none outside the grid.
std::optional<ViewPlace> place_of(const ViewNumbers& numbers, const Counted& counted,
                                  const ViewOrder& order) {
    const ViewGrid& grid = counted.grid;
    std::int64_t line = 0, step = 0;
    if (numbers.n) {
        const std::int64_t n = *numbers.n - *counted.first.n, length = line_length(grid, order);
        if (n < 0)
            return std::nullopt;
        line = n / length;
        step = n % length;
    } else {
        line = numbers.t.value_or(0) - *counted.first.t;
        step = numbers.s.value_or(0) - *counted.first.s;
        if (order.columns)
            std::swap(line, step);
    }
    const std::int64_t lines = order.columns ? grid.s : grid.t;
    if (line < 0 || step < 0 || line >= lines || step >= line_length(grid, order))
        return std::nullopt;
    return place_in(grid, order, static_cast<std::uint32_t>(line),
                    static_cast<std::uint32_t>(step));
}

std::string name_at(const ViewPattern& pattern, const ViewOrder& order, const Counted& counted,
                    const ViewPlace& place) {
    const ViewStep at = step_of(counted.grid, order, place);
    if (pattern.is_running())
        return pattern.name_of({.n = *counted.first.n +
                                     std::int64_t{at.line} * line_length(counted.grid, order) +
                                     at.step});
    return pattern.name_of({.s = *counted.first.s + (order.columns ? at.line : at.step),
                            .t = *counted.first.t + (order.columns ? at.step : at.line)});
}

// The names of all views, that of (s, t) at t * grid.s + s.
Result<std::vector<std::string>> complete_grid(const Numbered& views, const Counted& counted,
                                               const NamedViews& found) {
    std::map<std::uint64_t, std::string> at;
    for (const auto& [numbers, name] : views) {
        const auto place = place_of(numbers, counted, found.order);
        if (!place)
            return Status(ErrorCode::invalid_file,
                          name + ": outside the " + to_string(found.grid) + " views");
        const auto [other, fresh] =
            at.emplace(std::uint64_t{place->t} * found.grid.s + place->s, name);
        if (!fresh)
            return Status(ErrorCode::invalid_file,
                          "two files for one view: " + other->second + " and " + name);
    }
    std::vector<std::string> names;
    for (const auto& [index, name] : at) {
        if (index != names.size())
            break;
        names.push_back(name);
    }
    if (names.size() == found.grid.count())
        return names;
    const ViewPlace missing{static_cast<std::uint32_t>(names.size() % found.grid.s),
                            static_cast<std::uint32_t>(names.size() / found.grid.s)};
    return Status(ErrorCode::invalid_file, name_at(found.pattern, found.order, counted, missing) +
                                               ": this view is missing from " +
                                               to_string(found.grid) + " views");
}

} // namespace

Result<ViewPattern> recognise_view_names(const std::vector<std::string>& names,
                                         const ViewOrder& order) {
    for (const char* usual :
         {usual_view_pattern, "view_t{t:3}_s{s:3}.exr", "view_t{t:3}_s{s:3}.jpg"}) {
        TESSERA_TRY_ASSIGN(auto pattern, ViewPattern::parse(usual));
        if (std::ranges::any_of(names, [&](auto& n) { return pattern.match(n).has_value(); }))
            return pattern;
    }
    NameKinds kinds;
    for (const std::string& name : names)
        kinds[kind_of_name(cut_at_numbers(name))].push_back(name);
    TESSERA_TRY_ASSIGN(const auto views, only_series(kinds));
    std::vector<CutName> cuts;
    for (const std::string& name : views)
        cuts.push_back(cut_at_numbers(name));
    if (cuts.front().numbers.empty())
        return Status(ErrorCode::bad_argument,
                      "the name " + names.front() +
                          " has no number that could say which view it is");
    TESSERA_TRY_ASSIGN(const auto text, pattern_of(cuts, order));
    return ViewPattern::parse(text);
}

Result<NamedViews> arrange_views(const std::vector<std::string>& names, const ViewHints& hints,
                                 const std::optional<ViewGrid>& known_grid) {
    NamedViews found;
    found.order = hints.order.value_or(ViewOrder{});
    if (hints.pattern.empty()) {
        TESSERA_TRY_ASSIGN(found.pattern, recognise_view_names(names, found.order));
    } else {
        TESSERA_TRY_ASSIGN(found.pattern, ViewPattern::parse(hints.pattern));
    }
    Numbered views;
    for (const std::string& name : names)
        if (const auto numbers = found.pattern.match(name))
            views.emplace_back(*numbers, name);
    if (views.empty())
        return Status(ErrorCode::invalid_file, "holds no picture whose name fits '" +
                                                   found.pattern.text() + "'" +
                                                   (names.empty() ? "" : ", but " + names.front()));
    std::optional<ViewGrid> known = hints.grid ? hints.grid : known_grid;
    const bool is_ours = found.pattern.text().starts_with("view_t{t");
    TESSERA_TRY_ASSIGN(const Counted counted, found.pattern.is_running()
                                                  ? count_running(views, known)
                                                  : count_placed(views, known, is_ours));
    found.grid = counted.grid;
    TESSERA_TRY_ASSIGN(found.names, complete_grid(views, counted, found));
    found.axes_are_guessed = hints.pattern.empty() && !is_ours && !hints.order &&
                             !letters_tell_axes(found.names.front(), found.names.back());
    found.pattern.begin_at(counted.first);
    return found;
}

std::string view_name(const ViewPattern& pattern, const ViewOrder& order, const ViewGrid& grid,
                      const ViewPlace& place) {
    return name_at(pattern, order, {.grid = grid, .first = {.s = 0, .t = 0, .n = 0}}, place);
}

} // namespace tessera
