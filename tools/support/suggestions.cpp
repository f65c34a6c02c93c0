#include "tools/support/suggestions.h"

#include "tools/support/parse.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace tessera {
namespace {

constexpr std::size_t most_named = 3;
constexpr std::size_t least_letters = 3; // of a part that says something

// Without dashes in front, in small letters.
std::string letters_of(std::string_view word) {
    word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
    std::string letters(word);
    for (char& c : letters)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return letters;
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

std::vector<std::string> that_hold(const std::string& word, const std::vector<std::string>& known) {
    const std::string letters = letters_of(word);
    std::vector<std::string> holding;
    for (const std::string& candidate : known)
        if (letters.size() >= least_letters &&
            letters_of(candidate).find(letters) != std::string::npos)
            holding.push_back(candidate);
    return holding;
}

} // namespace

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
    std::vector<std::string> near = nearest_by_letters(word, known);
    if (near.empty())
        near = that_hold(word, known);
    if (near.empty())
        return "";
    near.resize(std::min(near.size(), most_named));
    std::string text = "; did you mean ";
    for (std::size_t i = 0; i < near.size(); ++i)
        text += (i == 0 ? "" : i + 1 == near.size() ? " or " : ", ") + near[i];
    return text + "?";
}

} // namespace tessera
