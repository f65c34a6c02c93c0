// Pictures as textures, light and views. The first byte selects the reader, the rest is the file: I
// a texture of a model, L light, P a view, Q a quilt, E a mosaic, F a
// film.
#include "corpus/picture_file.h"
#include "format/io/bytes.h"
#include "tests/fuzz/fuzz_target.h"
#include "tools/picture/picture_encoders.h"
#include "tools/texture_io/film_io.h"
#include "tools/texture_io/picture_io.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>
#include <algorithm>
#include <unistd.h>

namespace tessera::fuzz::pictures {
namespace {

constexpr std::uint64_t most_texels = 1 << 16;
constexpr std::size_t png_start = 9; // after our byte and the signature

std::uint32_t crc32(std::span<const std::byte> bytes) {
    std::uint32_t crc = 0xFFFFFFFF;
    for (const std::byte b : bytes) {
        crc ^= std::to_integer<std::uint32_t>(b);
        for (int i = 0; i < 8; ++i)
            crc = crc & 1 ? crc >> 1 ^ 0xEDB88320 : crc >> 1;
    }
    return ~crc;
}

std::uint32_t big_endian(const std::byte* at) {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i)
        value = value << 8 | std::to_integer<std::uint32_t>(at[i]);
    return value;
}

void read_all(const Result<std::unique_ptr<TexelSource>>& source) {
    if (!source.ok())
        return;
    const TextureDesc& desc = (*source)->desc();
    if (texel_count(desc.size) > most_texels)
        return;
    const Box4 whole = Box4::whole(desc.size);
    Bytes texels(desc.box_bytes(whole));
    if ((*source)->begin_slab(whole).ok())
        (void)(*source)->read(whole, texels);
}

Bytes exr_seed(int width, int height, Imf::RgbaChannels channels) {
    const std::string path = "/tmp/tessera_fuzz_" + std::to_string(::getpid()) + ".exr";
    {
        const std::vector<Imf::Rgba> pixels(static_cast<std::size_t>(width * height),
                                            Imf::Rgba(0.5f, 0.25f, 1, 1));
        Imf::RgbaOutputFile file(path.c_str(), width, height, channels);
        file.setFrameBuffer(pixels.data(), 1, static_cast<std::size_t>(width));
        file.writePixels(height);
    }
    std::ifstream in(path, std::ios::binary);
    const Bytes seed = bytes_of(std::string((std::istreambuf_iterator<char>(in)), {}));
    ::unlink(path.c_str());
    return seed;
}

// Floats in a layer, in scanlines or in tiles of two levels.
Bytes layered_exr_seed(bool tiled) {
    const std::string path = "/tmp/tessera_fuzz_" + std::to_string(::getpid()) + ".exr";
    {
        Imf::Header header(8, 4);
        header.compression() = tiled ? Imf::PIZ_COMPRESSION : Imf::ZIP_COMPRESSION;
        Imf::FrameBuffer frame;
        std::vector<float> values(32, 1e5f);
        for (const char* name : {"a.R", "a.G", "a.B", "depth.Z"}) {
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            frame.insert(name,
                         Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 32));
        }
        if (tiled) {
            header.setTileDescription(Imf::TileDescription(4, 4, Imf::MIPMAP_LEVELS));
            Imf::TiledOutputFile file(path.c_str(), header);
            file.setFrameBuffer(frame);
            for (int level = 0; level < file.numLevels(); ++level)
                file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
        } else {
            Imf::OutputFile file(path.c_str(), header);
            file.setFrameBuffer(frame);
            file.writePixels(4);
        }
    }
    std::ifstream in(path, std::ios::binary);
    const Bytes seed = bytes_of(std::string((std::istreambuf_iterator<char>(in)), {}));
    ::unlink(path.c_str());
    return seed;
}

Bytes with_selector(char selector, const Bytes& file) {
    Bytes input{static_cast<std::byte>(selector)};
    input.insert(input.end(), file.begin(), file.end());
    return input;
}

// Small files of the kinds that nothing of ours writes.
std::vector<Bytes> foreign_seeds() {
    using namespace std::string_view_literals;
    return {
        // WebP: lossless.
        bytes_of(
            "I"
            "\x52\x49\x46\x46\x36\x00\x00\x00\x57\x45\x42\x50\x56\x50\x38\x4c\x2a\x00\x00\x00\x2f"
            "\x0f\xc0\x03\x00\x1f\x20\x10\x48\xda\x1f\x7a\x8d\xf9\x17\x10\x14\xf9\x3f\xda\xfc\x07"
            "\x5f\x24\x80\x30\xdb\x68\x92\x93\x9c\xe4\xbd\xcf\x20\xa2\xff\xb1\xe9\x07\xf5\x01"sv),
        // The same as a view.
        bytes_of(
            "P"
            "\x52\x49\x46\x46\x36\x00\x00\x00\x57\x45\x42\x50\x56\x50\x38\x4c\x2a\x00\x00\x00\x2f"
            "\x0f\xc0\x03\x00\x1f\x20\x10\x48\xda\x1f\x7a\x8d\xf9\x17\x10\x14\xf9\x3f\xda\xfc\x07"
            "\x5f\x24\x80\x30\xdb\x68\x92\x93\x9c\xe4\xbd\xcf\x20\xa2\xff\xb1\xe9\x07\xf5\x01"sv),
        // BMP: 2x2 pixels of 24 bits, then of 1 bit with a palette.
        bytes_of("IBM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\2\0\0\0\2\0\0\0\1\0\x18\0\0\0\0\0\0\0\0"
                 "\0\0\0\0\0"
                 "\0\0\0\0\0\0\0\0\0\0\0\0\0abcdef\0\0ghijkl\0\0"sv),
        bytes_of("IBM\x46\0\0\0\0\0\0\0\x3e\0\0\0\x28\0\0\0\2\0\0\0\2\0\0\0\1\0\1\0\0\0\0\0\0\0\0\0"
                 "\0\0\0\0"
                 "\0\0\0\0\0\0\0\0\0\0\0\0\0abc\0def\0\x80\0\0\0\x40\0\0\0"sv),
        // TGA: 4x2 pixels with run lengths, in colour and with a palette.
        bytes_of("I\0\0\x0a\0\0\0\0\0\0\0\0\0\4\0\2\0\x20\x28\x83wxyz\3abcdefghijklmnop"sv),
        bytes_of("I\0\1\x09\0\0\2\0\x18\0\0\0\0\4\0\2\0\x08\0abcdef\x86\0\0\1"sv),
        // Netpbm: text, 16 bits, floats.
        bytes_of("PP3 2 1 255\n1 2 3 40 50 60\n"sv), bytes_of("PP5 2 2 1023\n\0\1\2\3\1\1\2\2"sv),
        bytes_of("PPF 1 1 -1\n\0\0\x80\x3f\0\0\0\x40\0\0\x80\x40"sv),
        bytes_of("LPf 1 1 1\n\x3f\x80\0\0"sv),
        // TIFF: 4x2 grey pixels in two strips.
        bytes_of("PII*\0\x10\0\0\0abcdefgh\x09\0\0\1\3\0\1\0\0\0\4\0\0\0\1\1\3\0\1\0\0\0\2\0\0\0"
                 "\2\1\3\0\1\0\0\0\x08\0\0\0\3\1\3\0\1\0\0\0\1\0\0\0\6\1\3\0\1\0\0\0\1\0\0\0"
                 "\x11\1\3\0\1\0\0\0\x08\0\0\0\x15\1\3\0\1\0\0\0\1\0\0\0\x16\1\3\0\1\0\0\0\2\0\0\0"
                 "\x17\1\4\0\1\0\0\0\x08\0\0\0\0\0\0\0"sv),
        // A film of one frame.
        bytes_of("FYUV4MPEG2 W4 H2 F25:1 Ip C420jpeg\nFRAME\nabcdefghklmn"sv),
        // Radiance: new runs, then old ones in columns.
        bytes_of("L#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n"
                 "\2\2\0\x08\x88q\x04wxyz\x84u\x88v\x88\x80"sv),
        bytes_of("L#?RGBE\nFORMAT=32-bit_rle_xyze\n\n+X 2 -Y 3\n"
                 "abc\x81\1\1\1\2def\x80ghi\x7fjkl\x82"sv)};
}

} // namespace

// Corrects the CRC of every chunk of a PNG.
void mend(Bytes& input) {
    if (input.size() < 2 || input[1] != std::byte{0x89})
        return;
    for (std::size_t at = png_start; at + 12 <= input.size();) {
        const std::size_t length = big_endian(&input[at]);
        if (length > input.size() - at - 12)
            return;
        const std::uint32_t crc = crc32(std::span(input).subspan(at + 4, length + 4));
        for (std::size_t i = 0; i < 4; ++i)
            input[at + 8 + length + i] = static_cast<std::byte>(crc >> (24 - 8 * i));
        at += 12 + length;
    }
}

std::vector<Bytes> seeds() {
    std::vector<Bytes> all = foreign_seeds();
    const std::pair<std::uint8_t, char> pngs[] = {{1, 'P'}, {2, 'Q'}, {3, 'Q'}, {4, 'P'}, {4, 'I'}};
    for (const auto& [channels, selector] : pngs) {
        const PixelSize size{8, 4, channels};
        all.push_back(with_selector(
            selector, *encode_png(size, Bytes(size.row_bytes() * size.height, std::byte{77}))));
    }
    const Bytes jpeg = *encode_jpeg({8, 8, 1}, Bytes(64, std::byte{99}), 80);
    all.push_back(with_selector('P', jpeg));
    all.push_back(with_selector('I', jpeg));
    all.push_back(with_selector('E', exr_seed(8, 4, Imf::WRITE_RGBA)));
    all.push_back(with_selector('E', exr_seed(8, 4, Imf::WRITE_YC)));
    all.push_back(with_selector('E', layered_exr_seed(false)));
    all.push_back(with_selector('E', layered_exr_seed(true)));
    all.push_back(with_selector('L', exr_seed(4, 4, Imf::WRITE_RGB)));
    return all;
}

void run(const std::uint8_t* data, std::size_t size) {
    if (size == 0)
        return;
    const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
    if (data[0] == 'I') {
        if (const auto image = corpus::decode_image({data + 1, size - 1}); image.ok())
            require(image->texels.size() == std::size_t{image->width} * image->height,
                    "a picture of another size");
        return;
    }
    if (data[0] == 'L') {
        const auto file = wrap_memory(bytes);
        if (const auto image = corpus::read_light_image(*file); image.ok())
            require(image->texels.size() == std::size_t{image->width} * image->height,
                    "light of another size");
        return;
    }
    TextureHints hints;
    hints.threads = 1;
    if (data[0] == 'E')
        hints.size = Extent4{4, 2, 2, 2};
    if (data[0] == 'Q')
        hints.views.quilt = ViewGrid{4, 1};
    ViewsFacts facts;
    if (data[0] == 'F') {
        read_all(open_film(wrap_memory(bytes), hints, facts));
        return;
    }
    read_all(open_picture(wrap_memory(bytes), hints, facts));
}

const Registered
    registered({.name = "fuzz_pictures", .seeds = seeds, .run = run, .mend = mend, .rounds = 1200});

} // namespace tessera::fuzz::pictures
