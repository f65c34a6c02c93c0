// PNG, JPEG and EXR pictures as textures: the first byte says how they are taken, the rest is the file. All
// of it is read, or refused.
#include "format/io/bytes.h"
#include "tests/fuzz/fuzz_target.h"
#include "tools/picture/jpeg_file.h"
#include "tools/picture/png_file.h"
#include "tools/texture_io/exr_io.h"
#include "tools/texture_io/picture_io.h"

#include <ImfRgbaFile.h>
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

Bytes exr_seed(int width, int height) {
    const std::string path = "/tmp/tessera_fuzz_" + std::to_string(::getpid()) + ".exr";
    {
        const std::vector<Imf::Rgba> pixels(static_cast<std::size_t>(width * height),
                                            Imf::Rgba(0.5f, 0.25f, 1, 1));
        Imf::RgbaOutputFile file(path.c_str(), width, height, Imf::WRITE_RGBA);
        file.setFrameBuffer(pixels.data(), 1, static_cast<std::size_t>(width));
        file.writePixels(height);
    }
    std::ifstream in(path, std::ios::binary);
    Bytes seed = bytes_of("E" + std::string((std::istreambuf_iterator<char>(in)), {}));
    ::unlink(path.c_str());
    return seed;
}

} // namespace

// The CRC of every chunk of a PNG.
void mend(Bytes& input) {
    if (input.empty() || (input[0] != std::byte{'P'} && input[0] != std::byte{'Q'}))
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
    std::vector<Bytes> all;
    const std::pair<std::uint8_t, char> pictures[] = {{1, 'P'}, {2, 'Q'}, {3, 'Q'}, {4, 'P'}};
    for (const auto& [channels, first] : pictures) {
        const PngShape shape{8, 4, channels};
        Bytes png = *encode_png(shape, Bytes(shape.row_bytes() * shape.height, std::byte{77}));
        png.insert(png.begin(), static_cast<std::byte>(first));
        all.push_back(png);
    }
    const JpegShape grey{8, 8, 1};
    Bytes jpeg = *encode_jpeg(grey, Bytes(64, std::byte{99}), 80);
    jpeg.insert(jpeg.begin(), std::byte{'J'});
    all.push_back(jpeg);
    all.push_back(exr_seed(8, 4));
    all.push_back(exr_seed(4, 4));
    return all;
}

void run(const std::uint8_t* data, std::size_t size) {
    if (size == 0)
        return;
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    const Bytes file(bytes + 1, bytes + size);
    TextureHints hints;
    hints.threads = 1;
    if (data[0] == 'E')
        hints.size = Extent4{4, 2, 2, 2};
    if (data[0] == 'Q')
        hints.views.quilt = ViewGrid{4, 1};
    Description description;
    ViewsFacts facts;
    read_all(data[0] == 'E' ? open_exr(wrap_memory(file), hints, description)
                            : open_picture(wrap_memory(file), hints, facts));
}

const Registered
    registered({.name = "fuzz_pictures", .seeds = seeds, .run = run, .mend = mend, .rounds = 400});

} // namespace tessera::fuzz::pictures
