#include "tools/support/suggestions.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

namespace tessera {
namespace {

constexpr std::size_t most_named = 3;
constexpr std::size_t least_letters = 3; // of a part that identifies a word

// Without the leading dashes, in lower case.
std::string letters_of(std::string_view word) {
    word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
    std::string letters(word);
    for (char& c : letters)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return letters;
}

// How many letters to insert, drop, replace, or swap with their neighbour turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    // Distances from the first i letters of `a` to all beginnings of `b`; likewise for i-1 and i-2.
    std::vector<std::size_t> row(b.size() + 1), above, above_that;
    for (std::size_t j = 0; j <= b.size(); ++j)
        row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        above_that = std::exchange(above, row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = above[j - 1] + (a[i - 1] != b[j - 1]);
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], above_that[j - 2] + 1);
        }
    }
    return row[b.size()];
}

std::vector<std::string> nearest_by_letters(const std::string& word,
                                            const std::vector<std::string>& known) {
    const std::string letters = letters_of(word);
    std::size_t least = std::max<std::size_t>(1, letters.size() / 3);
    std::vector<std::string> nearest;
    for (const std::string& candidate : known) {
        const std::size_t distance = edit_distance(letters, letters_of(candidate));
        if (distance > least)
            continue;
        if (distance < least)
            nearest.clear();
        least = distance;
        nearest.push_back(candidate);
    }
    return nearest;
}

std::vector<std::string> words_that_contain(const std::string& word,
                                            const std::vector<std::string>& known) {
    const std::string letters = letters_of(word);
    std::vector<std::string> containing;
    for (const std::string& candidate : known)
        if (letters.size() >= least_letters &&
            letters_of(candidate).find(letters) != std::string::npos)
            containing.push_back(candidate);
    return containing;
}

} // namespace

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
    std::vector<std::string> near = nearest_by_letters(word, known);
    if (near.empty())
        near = words_that_contain(word, known);
    if (near.empty())
        return "";
    near.resize(std::min(near.size(), most_named));
    std::string text = "; did you mean ";
    for (std::size_t i = 0; i < near.size(); ++i)
        text += (i == 0 ? "" : i + 1 == near.size() ? " or " : ", ") + near[i];
    return text + "?";
}

} // namespace tessera
