// Lines, words and numbers of text files: .obj, .mtl, ASCII .ply and .stl.
#pragma once

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::corpus {

// Lines end with a line feed, a carriage return or both.
class LineReader {
public:
    explicit LineReader(std::string_view text) : rest_(text) {}

    // The next line without its line end. Empty at the end of the text.
    std::string_view next() {
        const std::size_t size = std::min(rest_.find_first_of("\r\n"), rest_.size());
        const std::string_view line = rest_.substr(0, size);
        rest_.remove_prefix(size);
        // If lines end with a single carriage return, a line feed after the header of a binary .ply
        // is data.
        const bool both = rest_.starts_with("\r\n") && !ends_with_carriage_return_;
        ends_with_carriage_return_ |= rest_.starts_with('\r') && !both;
        rest_.remove_prefix(both ? 2 : rest_.empty() ? 0 : 1);
        ++number_;
        return line;
    }
    bool at_end() const { return rest_.empty(); }
    std::string_view rest() const { return rest_; }
    // The number of the line that next() returned last, from 1.
    std::size_t number() const { return number_; }

private:
    std::string_view rest_;
    std::size_t number_ = 0;
    bool ends_with_carriage_return_ = false;
};

constexpr const char* white_space = " \t\v\f";

inline std::string_view trimmed(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(white_space), text.size()));
    return text.substr(0, text.find_last_not_of(white_space) + 1);
}

// Removes the first word from the text and returns it. Empty if there is none.
inline std::string_view take_word(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_not_of(white_space), text.size()));
    const std::string_view word = text.substr(0, text.find_first_of(white_space));
    text.remove_prefix(word.size());
    return word;
}

inline std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    while (!(line = trimmed(line)).empty())
        words.push_back(take_word(line));
    return words;
}

// Parses the whole word as a number, which may begin with a plus sign. False if it is not one.
template <class Number> bool parse_word(std::string_view word, Number& number) {
    word.remove_prefix(word.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc() && end == word.data() + word.size();
}

// Shortens the word, because words in damaged files can be very long.
inline std::string in_quotes(std::string_view word) {
    return "'" + std::string(word.substr(0, 40)) + "'";
}

} // namespace tessera::corpus
