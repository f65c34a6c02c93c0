#include "tools/support/view_order.h"

#include "tools/support/parse.h"
#include "tools/support/suggestions.h"

#include <string_view>
#include <utility>
#include <vector>

namespace tessera {
namespace {

constexpr std::uint64_t most_views = 1u << 20;

} // namespace

Result<ViewOrder> parse_view_order(const std::string& text) {
    ViewOrder order;
    const std::vector<std::pair<std::string, bool*>> words = {{"columns", &order.columns},
                                                              {"serpentine", &order.serpentine},
                                                              {"bottom-up", &order.bottom_up},
                                                              {"right-left", &order.right_left},
                                                              {"rows", nullptr}};
    std::string_view left = text;
    while (!left.empty()) {
        const std::string word(left.substr(0, left.find(',')));
        left.remove_prefix(std::min(left.size(), word.size() + 1));
        bool known = false;
        std::vector<std::string> names;
        for (const auto& [name, flag] : words) {
            names.push_back(name);
            if (word != name)
                continue;
            known = true;
            if (flag)
                *flag = true;
        }
        if (!known)
            return Status(ErrorCode::bad_argument,
                          "'" + word.substr(0, 100) +
                              "' is not one of: rows, columns, serpentine, bottom-up, right-left" +
                              did_you_mean(word, names));
    }
    return order;
}

std::string to_string(const ViewOrder& order) {
    std::string text;
    for (const auto& [word, is_set] :
         {std::pair("columns", order.columns), std::pair("serpentine", order.serpentine),
          std::pair("bottom-up", order.bottom_up), std::pair("right-left", order.right_left)})
        if (is_set)
            text += (text.empty() ? "" : ",") + std::string(word);
    return text;
}

ViewPlace place_in(const ViewGrid& grid, const ViewOrder& order, std::uint32_t line,
                   std::uint32_t step) {
    if (order.serpentine && line % 2 == 1)
        step = line_length(grid, order) - 1 - step;
    ViewPlace place = order.columns ? ViewPlace{line, step} : ViewPlace{step, line};
    if (order.bottom_up)
        place.t = grid.t - 1 - place.t;
    if (order.right_left)
        place.s = grid.s - 1 - place.s;
    return place;
}

ViewStep step_of(const ViewGrid& grid, const ViewOrder& order, const ViewPlace& place) {
    const std::uint32_t t = order.bottom_up ? grid.t - 1 - place.t : place.t;
    const std::uint32_t s = order.right_left ? grid.s - 1 - place.s : place.s;
    ViewStep found = order.columns ? ViewStep{s, t} : ViewStep{t, s};
    if (order.serpentine && found.line % 2 == 1)
        found.step = line_length(grid, order) - 1 - found.step;
    return found;
}

Result<ViewGrid> parse_view_grid(const std::string& text) {
    const std::size_t cross = text.find('x');
    std::uint64_t s = 0, t = 0;
    if (cross == std::string::npos || !parse_number(std::string_view(text).substr(0, cross), s) ||
        !parse_number(std::string_view(text).substr(cross + 1), t) || s < 1 || t < 1 ||
        s > most_views || t > most_views || s * t > most_views)
        return Status(ErrorCode::bad_argument,
                      "'" + text.substr(0, 100) +
                          "' is not a grid such as 9x9: columns x rows, at most " +
                          std::to_string(most_views) + " together");
    return ViewGrid{static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(t)};
}

std::string to_string(const ViewGrid& grid) {
    return std::to_string(grid.s) + "x" + std::to_string(grid.t);
}

} // namespace tessera
