// The pictures of Netpbm: PGM and PPM, binary or as text, of up to 16 bits; and PFM, their sibling of
// floats.
#include "corpus/picture/picture_readers.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

namespace tessera::corpus {
namespace {

constexpr std::size_t longest_header_word = 32;

bool is_header_blank(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

// The text of a header: words between blanks, and comments from # to the end of a line.
class HeaderWords {
public:
    explicit HeaderWords(std::span<const std::byte> file)
        : text_(reinterpret_cast<const char*>(file.data()), file.size()) {}
    // "" at the end of the file. `at()` is then behind one blank that ends the word.
    std::string next() {
        while (at_ < text_.size() && (is_header_blank(text_[at_]) || text_[at_] == '#'))
            if (text_[at_++] == '#')
                while (at_ < text_.size() && text_[at_] != '\n')
                    ++at_;
        std::string word;
        while (at_ < text_.size() && !is_header_blank(text_[at_]) &&
               word.size() < longest_header_word)
            word += text_[at_++];
        if (at_ < text_.size() && is_header_blank(text_[at_]))
            ++at_;
        return word;
    }
    std::size_t at() const { return at_; }

private:
    std::string_view text_;
    std::size_t at_ = 0;
};

template <class Number> bool parse_header_word(const std::string& word, Number& value) {
    const char* end = word.data() + word.size();
    const auto [rest, error] = std::from_chars(word.data(), end, value);
    return error == std::errc() && rest == end;
}

Status bad_word(const char* kind, const std::string& word, const char* what) {
    if (word.empty())
        return damaged(std::string(kind) + ": it ends too early");
    return damaged(std::string(kind) + ": '" + word + "' is not " + what);
}

Status read_header_size(const char* kind, HeaderWords& words, PictureShape& shape) {
    for (std::uint32_t* side : {&shape.width, &shape.height})
        if (const std::string word = words.next(); !parse_header_word(word, *side))
            return bad_word(kind, word, "its width or height");
    return check_size(shape.width, shape.height);
}

// Brings numbers from 0 to `most` to all 8 or 16 bits.
class Scaling {
public:
    explicit Scaling(unsigned most) : most_(most) {}
    unsigned full() const { return most_ > 255 ? 65535 : 255; }
    Status put(unsigned value, std::vector<std::byte>& samples) const {
        if (value > most_)
            return damaged("PNM: a sample of " + std::to_string(value) + " is above its maximum " +
                           std::to_string(most_));
        const auto scaled = static_cast<std::uint16_t>((value * full() + most_ / 2) / most_);
        const auto bytes = std::as_bytes(std::span(&scaled, 1));
        if (full() == 65535)
            samples.insert(samples.end(), bytes.begin(), bytes.end());
        else
            samples.push_back(static_cast<std::byte>(scaled));
        return {};
    }

private:
    unsigned most_;
};

} // namespace

Result<HeldPicture> read_pnm(std::span<const std::byte> file) {
    HeaderWords words(file);
    const std::string kind = words.next(); // P2, P3, P5 or P6
    HeldPicture picture;
    picture.shape.kind = PictureKind::pnm;
    picture.shape.channels = kind == "P3" || kind == "P6" ? 3 : 1;
    TESSERA_TRY(read_header_size("PNM", words, picture.shape));
    unsigned most = 0;
    if (const std::string word = words.next();
        !parse_header_word(word, most) || most == 0 || most > 65535)
        return bad_word("PNM", word, "a largest value from 1 to 65535");
    const Scaling scaling(most);
    picture.shape.bits = scaling.full() == 255 ? 8 : 16;
    const std::size_t count =
        std::size_t{picture.shape.width} * picture.shape.height * picture.shape.channels;
    const std::size_t bytes = picture.shape.bits / 8;
    const bool is_text = kind == "P2" || kind == "P3";
    const auto rest = file.subspan(words.at());
    if (rest.size() < (is_text ? 2 * count - 1 : bytes * count))
        return damaged("PNM: it ends too early");
    picture.integers.reserve(count * bytes);
    for (std::size_t i = 0; i < count; ++i) {
        unsigned value = 0;
        if (is_text) {
            if (const std::string word = words.next(); !parse_header_word(word, value))
                return bad_word("PNM", word, "a sample");
        } else {
            for (std::size_t b = 0; b < bytes; ++b) // the high byte first
                value = value << 8 | std::to_integer<unsigned>(rest[i * bytes + b]);
        }
        TESSERA_TRY(scaling.put(value, picture.integers));
    }
    return picture;
}

Result<HeldPicture> read_pfm(std::span<const std::byte> file) {
    HeaderWords words(file);
    const std::string kind = words.next(); // PF or Pf
    HeldPicture picture;
    picture.shape = {.kind = PictureKind::pfm,
                     .channels = static_cast<std::uint8_t>(kind == "PF" ? 3 : 1),
                     .bits = 16,
                     .is_float = true};
    TESSERA_TRY(read_header_size("PFM", words, picture.shape));
    float scale = 0; // its sign is the byte order
    if (const std::string word = words.next();
        !parse_header_word(word, scale) || !std::isfinite(scale) || scale == 0)
        return bad_word("PFM", word, "its scale, which is not 0");
    const bool swaps = (scale > 0) == (std::endian::native == std::endian::little);
    const std::size_t line = std::size_t{picture.shape.width} * picture.shape.channels;
    auto rest = file.subspan(words.at());
    if (rest.size() / 4 < line * picture.shape.height)
        return damaged("PFM: it ends too early");
    picture.floats.resize(line * picture.shape.height);
    for (std::uint32_t y = picture.shape.height; y-- > 0;) // from the bottom
        for (std::size_t i = 0; i < line; ++i) {
            std::uint32_t word = 0;
            std::memcpy(&word, rest.data(), 4);
            rest = rest.subspan(4);
            if (swaps)
                word = word >> 24 | (word >> 8 & 0xff00) | (word << 8 & 0xff0000) | word << 24;
            picture.floats[y * line + i] = std::bit_cast<float>(word);
        }
    return picture;
}

} // namespace tessera::corpus
