// Radiance pictures, as its color.c writes them: a text header, then scanlines of RGBE pixels.
#include "corpus/picture/picture_readers.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tessera::corpus {
namespace {

constexpr std::size_t longest_line = 2048;

struct HdrHeader {
    bool is_xyz = false;
    // The slow axis goes from scanline to scanline, the fast one along each.
    struct Direction {
        bool is_x = false, ascends = false; // x to the right, y downwards
        std::uint32_t size = 0;
    } slow, fast;
};

// The next line without its end.
Result<std::string> read_line(ByteReader& in) {
    std::string line;
    while (line.size() <= longest_line) {
        const auto c = static_cast<char>(in.number(1));
        if (!in.ok())
            return damaged("HDR: it ends too early");
        if (c == '\n') {
            if (line.ends_with('\r'))
                line.pop_back();
            return line;
        }
        line += c;
    }
    return damaged("HDR: a line of its header is too long");
}

// "-Y 512 +X 1024": rows from the top, pixels from the left. Y grows upwards.
bool parse_resolution(const std::string& line, HdrHeader& header) {
    const char *at = line.data(), *end = at + line.size();
    for (HdrHeader::Direction* direction : {&header.slow, &header.fast}) {
        while (at != end && *at == ' ')
            ++at;
        if (end - at < 4 || (at[0] != '-' && at[0] != '+') || (at[1] != 'X' && at[1] != 'Y') ||
            at[2] != ' ')
            return false;
        direction->is_x = at[1] == 'X';
        direction->ascends = (at[0] == '+') == direction->is_x;
        const auto [rest, error] = std::from_chars(at + 3, end, direction->size);
        if (error != std::errc())
            return false;
        at = rest;
    }
    return at == end && header.slow.is_x != header.fast.is_x;
}

Result<HdrHeader> read_hdr_header(ByteReader& in) {
    HdrHeader header;
    TESSERA_TRY(read_line(in)); // the signature
    for (std::string line = "#"; !line.empty();) {
        TESSERA_TRY_ASSIGN(line, read_line(in));
        if (!line.starts_with("FORMAT="))
            continue;
        header.is_xyz = line == "FORMAT=32-bit_rle_xyze";
        if (!header.is_xyz && line != "FORMAT=32-bit_rle_rgbe")
            return Status(ErrorCode::unsupported, "an HDR picture with " + line);
    }
    TESSERA_TRY_ASSIGN(const std::string resolution, read_line(in));
    if (!parse_resolution(resolution, header))
        return damaged("HDR: '" + resolution + "' is not its size, such as '-Y 512 +X 1024'");
    return header;
}

using Rgbe = std::array<std::uint8_t, 4>;

// The four components one after the other, each in runs of equal and of different bytes.
Status read_new_runs(ByteReader& in, std::span<Rgbe> scanline) {
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t x = 0; x < scanline.size();) {
            const std::uint32_t code = in.number(1);
            const std::size_t length = code > 128 ? code - 128 : code;
            if (!in.ok())
                return damaged("HDR: it ends too early");
            if (length == 0 || length > scanline.size() - x)
                return damaged("HDR: a run of " + std::to_string(length) +
                               " pixels in a scanline of " + std::to_string(scanline.size()));
            std::uint32_t value = 0;
            for (std::size_t k = 0; k < length; ++k) {
                if (k == 0 || code <= 128)
                    value = in.number(1);
                scanline[x++][c] = static_cast<std::uint8_t>(value);
            }
        }
    return {};
}

// Pixels, where (1,1,1,n) repeats the last one; more of these in a row are higher digits of its
// count.
Status read_old_runs(ByteReader& in, Rgbe pixel, std::span<Rgbe> scanline) {
    unsigned shift = 0;
    for (std::size_t x = 0; x < scanline.size();) {
        if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
            const std::uint64_t length = std::uint64_t{pixel[3]} << shift;
            if (x == 0 || shift > 24 || length > scanline.size() - x)
                return damaged("HDR: a run leaves its scanline");
            std::fill_n(scanline.begin() + static_cast<std::ptrdiff_t>(x), length, scanline[x - 1]);
            x += length;
            shift += 8;
        } else {
            scanline[x++] = pixel;
            shift = 0;
        }
        if (x < scanline.size())
            for (std::uint8_t& byte : pixel)
                byte = static_cast<std::uint8_t>(in.number(1));
    }
    return {};
}

Status read_scanline(ByteReader& in, std::span<Rgbe> scanline) {
    Rgbe first;
    for (std::uint8_t& byte : first)
        byte = static_cast<std::uint8_t>(in.number(1));
    const bool is_new = scanline.size() >= 8 && scanline.size() < 32768 && first[0] == 2 &&
                        first[1] == 2 && first[2] < 128;
    if (!is_new)
        return read_old_runs(in, first, scanline);
    if (first[2] * 256u + first[3] != scanline.size())
        return damaged("HDR: a scanline has another length than the picture");
    return read_new_runs(in, scanline);
}

glm::vec3 to_light(const Rgbe& pixel, bool is_xyz) {
    if (pixel[3] == 0)
        return glm::vec3(0.0f);
    const glm::vec3 light =
        glm::vec3(pixel[0], pixel[1], pixel[2]) * std::ldexp(1.0f, pixel[3] - (128 + 8));
    if (!is_xyz)
        return light;
    const auto sum = [&](float x, float y, float z) { // without colours outside of the gamut
        return std::max(0.0f, x * light.x + y * light.y + z * light.z);
    };
    return {sum(3.2404542f, -1.5371385f, -0.4985314f), sum(-0.9692660f, 1.8760108f, 0.0415560f),
            sum(0.0556434f, -0.2040259f, 1.0572252f)};
}

} // namespace

Result<LightImage> read_hdr(std::span<const std::byte> file) {
    ByteReader in(file);
    TESSERA_TRY_ASSIGN(const auto header, read_hdr_header(in));
    const auto& [is_xyz, slow, fast] = header;
    LightImage image{slow.is_x ? slow.size : fast.size, slow.is_x ? fast.size : slow.size, {}};
    TESSERA_TRY(check_size(image.width, image.height));
    if (in.left() / 4 < slow.size) // a scanline has a pixel or a mark at least
        return damaged("HDR: it ends too early");
    image.texels.resize(std::size_t{image.width} * image.height);
    std::vector<Rgbe> scanline(fast.size);
    for (std::uint32_t i = 0; i < slow.size; ++i) {
        TESSERA_TRY(read_scanline(in, scanline));
        if (!in.ok())
            return damaged("HDR: it ends too early");
        for (std::uint32_t k = 0; k < fast.size; ++k) {
            const std::size_t a = slow.ascends ? i : slow.size - 1 - i;
            const std::size_t b = fast.ascends ? k : fast.size - 1 - k;
            image.texels[slow.is_x ? b * image.width + a : a * image.width + b] =
                to_light(scanline[k], is_xyz);
        }
    }
    return image;
}

} // namespace tessera::corpus
