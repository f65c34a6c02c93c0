#include "corpus/model/ply_check.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::corpus {
namespace {

struct Number {
    std::string_view name, other_name;
    std::size_t bytes;
    bool is_whole, has_sign;
};
constexpr Number numbers[] = {
    {"char", "int8", 1, true, true},      {"uchar", "uint8", 1, true, false},
    {"short", "int16", 2, true, true},    {"ushort", "uint16", 2, true, false},
    {"int", "int32", 4, true, true},      {"uint", "uint32", 4, true, false},
    {"float", "float32", 4, false, true}, {"double", "float64", 8, false, true},
};

const Number* number_of(std::string_view name) {
    const auto* const found = std::ranges::find_if(
        numbers, [&](const Number& n) { return n.name == name || n.other_name == name; });
    return found == std::end(numbers) ? nullptr : found;
}

struct Property {
    const Number* count = nullptr; // of a list
    const Number* value = nullptr;
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t at = 0; at < line.size();) {
        const std::size_t begin = at;
        while (at < line.size() && is_space(line[at]) == is_space(line[begin]))
            ++at;
        if (!is_space(line[begin]))
            words.push_back(line.substr(begin, at - begin));
    }
    return words;
}

template <class Value> bool is_number(std::string_view word, Value& value) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size();
}

class PlyWalk {
public:
    explicit PlyWalk(std::string_view file) : rest_(file), size_(file.size()) {}

    Status check() {
        TESSERA_TRY(read_header());
        for (const Element& element : elements_)
            TESSERA_TRY((is_text_ ? walk_text(element) : walk_binary(element))
                            .with_context("element " + element.name));
        return {};
    }

private:
    static Status wrong(const std::string& what) { return {ErrorCode::invalid_file, what}; }
    Status wrong_line() const { return wrong("line " + std::to_string(line_) + " is not PLY's"); }

    // Up to a line feed, a carriage return or both.
    std::string_view take_line() {
        const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
        const std::string_view line = rest_.substr(0, end);
        rest_.remove_prefix(end);
        rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : rest_.empty() ? 0 : 1);
        ++line_;
        return line;
    }

    Status read_header() {
        if (take_line() != "ply")
            return wrong_line();
        while (!rest_.empty()) {
            const std::vector<std::string_view> words = words_of(take_line());
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info")
                continue;
            if (words[0] == "end_header" && words.size() == 1)
                return {};
            if (!(words[0] == "format"     ? read_format(words)
                  : words[0] == "element"  ? read_element(words)
                  : words[0] == "property" ? read_property(words)
                                           : false))
                return wrong_line();
        }
        return wrong("its header has no end");
    }

    bool read_format(const std::vector<std::string_view>& words) {
        if (words.size() != 3)
            return false;
        is_text_ = words[1] == "ascii";
        is_big_ = words[1] == "binary_big_endian";
        return is_text_ || is_big_ || words[1] == "binary_little_endian";
    }

    bool read_element(const std::vector<std::string_view>& words) {
        Element element;
        if (words.size() != 3 || (words[1][0] >= '0' && words[1][0] <= '9') ||
            !is_number(words[2], element.count) || element.count > size_)
            return false;
        element.name = words[1];
        elements_.push_back(std::move(element));
        return true;
    }

    bool read_property(const std::vector<std::string_view>& words) {
        const bool is_list = words.size() == 5 && words[1] == "list";
        if (elements_.empty() || (!is_list && words.size() != 3))
            return false;
        Property property;
        property.value = number_of(words[words.size() - 2]);
        property.count = is_list ? number_of(words[2]) : nullptr;
        elements_.back().properties.push_back(property);
        return property.value != nullptr &&
               (!is_list || (property.count != nullptr && property.count->is_whole));
    }

    Status walk_text(const Element& element) {
        for (std::uint64_t i = 0; i < element.count && !element.properties.empty();) {
            if (rest_.empty())
                return wrong("the file ends before it does");
            const std::vector<std::string_view> words = words_of(take_line());
            if (words.empty() || words[0] == "comment")
                continue;
            std::size_t next = 0;
            for (const Property& property : element.properties) {
                std::uint64_t values = 1;
                if (property.count != nullptr &&
                    (next == words.size() || !is_number(words[next++], values)))
                    return wrong_line();
                for (; values > 0; --values)
                    if (next == words.size() || !is_value(words[next++], *property.value))
                        return wrong_line();
            }
            if (next != words.size())
                return wrong_line();
            ++i;
        }
        return {};
    }

    static bool is_value(std::string_view word, const Number& number) {
        word.remove_prefix(word.starts_with('+') ? 1 : 0);
        std::int64_t whole = 0;
        double real = 0;
        return number.is_whole ? is_number(word, whole) : is_number(word, real);
    }

    Status walk_binary(const Element& element) {
        std::uint64_t fixed = 0;
        for (const Property& property : element.properties)
            fixed += property.count != nullptr ? property.count->bytes : property.value->bytes;
        if (element.count * fixed > rest_.size()) // both are below 2^32
            return wrong("the file is too short for it");
        if (std::ranges::none_of(element.properties, &Property::count)) {
            rest_.remove_prefix(element.count * fixed);
            return {};
        }
        for (std::uint64_t i = 0; i < element.count; ++i)
            for (const Property& property : element.properties) {
                std::uint64_t values = 1;
                if (property.count != nullptr && !take_count(*property.count, values))
                    return wrong("a list's length is out of range");
                if (values > rest_.size() / property.value->bytes)
                    return wrong("the file is too short for it");
                rest_.remove_prefix(values * property.value->bytes);
            }
        return {};
    }

    bool take_count(const Number& number, std::uint64_t& count) {
        if (rest_.size() < number.bytes)
            return false;
        count = 0;
        for (std::size_t i = 0; i < number.bytes; ++i) {
            const std::size_t at = is_big_ ? i : number.bytes - 1 - i;
            count = count << 8 | static_cast<unsigned char>(rest_[at]);
        }
        rest_.remove_prefix(number.bytes);
        return !number.has_sign || count >> (8 * number.bytes - 1) == 0;
    }

    std::string_view rest_;
    const std::size_t size_;
    std::vector<Element> elements_;
    bool is_text_ = false, is_big_ = false;
    std::size_t line_ = 0;
};

} // namespace

Status check_ply(std::span<const std::byte> file) {
    return PlyWalk({reinterpret_cast<const char*>(file.data()), file.size()}).check();
}

} // namespace tessera::corpus
