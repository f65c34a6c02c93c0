#include "corpus/picture/packed_pixels.h"
#include "corpus/picture/picture_readers.h"

#include <optional>

namespace tessera::corpus {
namespace {

struct TgaHeader {
    std::uint32_t id_bytes = 0,
                  kind = 0; // kind: 1 palette, 2 colour, 3 grey; 8 more with run lengths
    std::uint32_t first = 0, entries = 0, entry_bits = 0; // of the palette
    std::uint32_t width = 0, height = 0, bits = 0;        // bits: per pixel
    bool from_right = false, from_top = false;
};

std::optional<PixelMasks> masks_of(std::uint32_t bits, bool is_grey) {
    if (is_grey)
        return bits == 8    ? std::optional(PixelMasks{0xff, 0xff, 0xff, 0})
               : bits == 16 ? std::optional(PixelMasks{0xff, 0xff, 0xff, 0xff00})
                            : std::nullopt;
    switch (bits) {
    case 15:
    case 16:
        return masks_555; // the highest bit is no alpha in practice
    case 24:
        return masks_888;
    case 32:
        return masks_8888;
    default:
        return std::nullopt;
    }
}

// The file has no signature, so all fields with few valid values are checked.
Result<TgaHeader> read_tga_header(ByteReader& in) {
    TgaHeader header;
    header.id_bytes = in.number(1);
    const std::uint32_t has_palette = in.number(1);
    header.kind = in.number(1);
    header.first = in.number(2);
    header.entries = in.number(2);
    header.entry_bits = in.number(1);
    in.take(4); // the origin on a screen
    header.width = in.number(2);
    header.height = in.number(2);
    header.bits = in.number(1);
    const std::uint32_t order = in.number(1);
    header.from_right = (order & 16) != 0;
    header.from_top = (order & 32) != 0;
    const std::uint32_t kind = header.kind & ~8u;
    const bool is_sound =
        in.ok() && has_palette <= 1 && kind >= 1 && kind <= 3 && (order & 192) == 0 &&
        (kind == 1 ? has_palette == 1 && (header.bits == 8 || header.bits == 16) &&
                         masks_of(header.entry_bits, false)
                   : masks_of(header.bits, kind == 3).has_value());
    if (!is_sound)
        return Status(ErrorCode::invalid_file,
                      "not a picture of a known kind (PNG, JPEG, WebP, BMP, TGA)");
    return header;
}

// Turns the words of a file into colours.
class TgaColours {
public:
    Status read_palette(ByteReader& in, const TgaHeader& header) {
        const bool is_palette = (header.kind & 7) == 1;
        masks_ = *masks_of(is_palette ? header.entry_bits : header.bits, (header.kind & 7) == 3);
        const std::size_t bytes = (header.entry_bits + 7) / 8;
        if (!is_palette) {
            in.take(header.entries * bytes);
            return {};
        }
        first_ = header.first;
        for (std::uint32_t i = 0; i < header.entries && in.ok(); ++i)
            palette_.push_back(unpack(in.number(bytes), masks_));
        return palette_.empty() ? damaged("TGA: its palette is empty") : Status();
    }
    Result<std::array<std::uint8_t, 4>> colour(std::uint32_t word) const {
        if (palette_.empty())
            return unpack(word, masks_);
        if (word - first_ >= palette_.size())
            return damaged("TGA: a pixel has colour " + std::to_string(word) + " of " +
                           std::to_string(palette_.size()));
        return palette_[word - first_];
    }

private:
    PixelMasks masks_;
    std::uint32_t first_ = 0;
    std::vector<std::array<std::uint8_t, 4>> palette_;
};

} // namespace

Result<Image> read_tga(std::span<const std::byte> file) {
    ByteReader in(file);
    TESSERA_TRY_ASSIGN(const auto header, read_tga_header(in));
    TESSERA_TRY(check_size(header.width, header.height));
    in.take(header.id_bytes);
    TgaColours colours;
    TESSERA_TRY(colours.read_palette(in, header));
    const std::size_t bytes = (header.bits + 7) / 8,
                      count = std::size_t{header.width} * header.height;
    const bool has_runs = (header.kind & 8) != 0;
    constexpr std::size_t longest_run = 128;
    if (in.left() <
        (has_runs ? (count + longest_run - 1) / longest_run * (1 + bytes) : count * bytes))
        return damaged("TGA: it ends too early");
    Image image{header.width, header.height, {}};
    image.texels.resize(count);
    for (std::size_t i = 0; i < count;) {
        const std::uint32_t packet = has_runs ? in.number(1) : 0;
        const std::size_t length = (packet & 127) + 1;
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < length && i < count; ++k, ++i) {
            if (k == 0 || packet < 128)
                word = in.number(bytes);
            TESSERA_TRY_ASSIGN(const auto texel, colours.colour(word));
            const std::size_t x = i % header.width, y = i / header.width;
            image.texels[(header.from_top ? y : header.height - 1 - y) * header.width +
                         (header.from_right ? header.width - 1 - x : x)] = texel;
        }
        if (!in.ok())
            return damaged("TGA: it ends too early");
    }
    return image;
}

} // namespace tessera::corpus
