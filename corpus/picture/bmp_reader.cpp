#include "corpus/picture/packed_pixels.h"
#include "corpus/picture/picture_readers.h"

#include <algorithm>
#include <cstdlib>

namespace tessera::corpus {
namespace {

constexpr std::size_t file_header_bytes = 14;

struct BmpHeader {
    std::uint64_t pixels = 0; // offset in the file
    std::uint64_t width = 0, height = 0;
    bool is_top_down = false;
    unsigned bits = 0; // per pixel
    PixelMasks masks;
    std::vector<std::array<std::uint8_t, 4>> palette;

    std::uint64_t line_bytes() const { return (width * bits + 31) / 32 * 4; }
};

constexpr std::uint32_t uncompressed = 0, bit_fields = 3, alpha_bit_fields = 6;

// Reads the sides, the depth and the masks from a header of `size` bytes.
Status read_info(ByteReader& in, std::uint32_t size, BmpHeader& header) {
    std::uint32_t compression = uncompressed;
    if (size == 12) { // OS/2
        header.width = in.number(2);
        header.height = in.number(2);
        in.take(2);
        header.bits = in.number(2);
    } else {
        header.width = in.number(4); // negative ones are too large
        const auto height = std::int64_t{static_cast<std::int32_t>(in.number(4))};
        header.height = static_cast<std::uint64_t>(std::abs(height));
        header.is_top_down = height < 0;
        in.take(2);
        header.bits = in.number(2);
        compression = in.number(4);
        in.take(20);
    }
    const bool is_masked = compression == bit_fields || compression == alpha_bit_fields;
    if (compression != uncompressed && !(is_masked && (header.bits == 16 || header.bits == 32)))
        return not_supported("a compressed BMP");
    header.masks = header.bits == 16 ? masks_555 : header.bits == 24 ? masks_888 : masks_8888;
    std::size_t read = std::min(size, 40u);
    if (is_masked) {
        header.masks = {in.number(4), in.number(4), in.number(4), 0};
        const bool has_alpha = compression == alpha_bit_fields || size >= 56;
        header.masks.alpha = has_alpha ? in.number(4) : 0;
        read += has_alpha ? 16 : 12;
    }
    if (read < size)
        in.take(size - read); // colour spaces
    return {};
}

Result<BmpHeader> read_bmp_header(std::span<const std::byte> file) {
    ByteReader in(file);
    BmpHeader header;
    in.take(10); // "BM", the file's size
    header.pixels = in.number(4);
    const std::uint32_t size = in.number(4);
    if (size != 12 && size < 40)
        return damaged("BMP: its header has " + std::to_string(size) + " bytes");
    TESSERA_TRY(read_info(in, size, header));
    const unsigned bits = header.bits;
    if (bits != 1 && bits != 4 && bits != 8 && bits != 16 && bits != 24 && bits != 32)
        return damaged("BMP: it has " + std::to_string(bits) + " bits per pixel");
    if (bits <= 8) {
        const std::size_t entry = size == 12 ? 3 : 4;
        const std::uint64_t read = file.size() - in.left();
        if (header.pixels < read)
            return damaged("BMP: its pixels begin in its header");
        const std::uint64_t entries =
            std::min<std::uint64_t>((header.pixels - read) / entry, 1u << bits);
        for (std::uint64_t i = 0; i < entries; ++i)
            header.palette.push_back(unpack(in.number(entry), masks_888));
    }
    if (!in.ok())
        return damaged("BMP: it ends too early");
    return header;
}

Status read_line(std::span<const std::byte> line, const BmpHeader& header,
                 std::array<std::uint8_t, 4>* texels) {
    ByteReader in(line);
    if (header.bits > 8) {
        for (std::uint64_t x = 0; x < header.width; ++x)
            texels[x] = unpack(in.number(header.bits / 8), header.masks);
        return {};
    }
    for (std::uint64_t x = 0; x < header.width; ++x) {
        const std::uint64_t bit = x * header.bits;
        const auto byte = std::to_integer<unsigned>(line[bit / 8]);
        const unsigned index = byte >> (8 - header.bits - bit % 8) & ((1u << header.bits) - 1);
        if (index >= header.palette.size())
            return damaged("BMP: a pixel has colour " + std::to_string(index) + " of " +
                           std::to_string(header.palette.size()));
        texels[x] = header.palette[index];
    }
    return {};
}

} // namespace

Result<Image> read_bmp(std::span<const std::byte> file) {
    TESSERA_TRY_ASSIGN(const auto header, read_bmp_header(file));
    TESSERA_TRY(check_size(header.width, header.height));
    const std::uint64_t line = header.line_bytes(), used = (header.width * header.bits + 7) / 8;
    // The last line may lack its padding.
    if (header.pixels + (header.height - 1) * line + used > file.size())
        return damaged("BMP: it ends too early");
    Image image{
        static_cast<std::uint32_t>(header.width), static_cast<std::uint32_t>(header.height), {}};
    image.texels.resize(header.width * header.height);
    for (std::uint64_t y = 0; y < header.height; ++y) {
        const std::uint64_t from = header.is_top_down ? y : header.height - 1 - y;
        TESSERA_TRY(read_line(file.subspan(header.pixels + from * line, used), header,
                              image.texels.data() + y * header.width));
    }
    // Many programs leave the fourth byte of 32 bits unused.
    if (std::ranges::all_of(image.texels, [](const auto& texel) { return texel[3] == 0; }))
        for (auto& texel : image.texels)
            texel[3] = 255;
    return image;
}

} // namespace tessera::corpus
