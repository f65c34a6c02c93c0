#include "tools/page/gzip.h"

#include <algorithm>
#include <zlib.h>

namespace tessera {

Result<std::vector<std::byte>> gzip(std::span<const std::byte> bytes) {
    constexpr int gzip_window = 15 + 16, most_memory = 9;
    constexpr std::size_t step = 1u << 30; // zlib counts in 32 bits
    z_stream stream{};
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, gzip_window, most_memory,
                     Z_DEFAULT_STRATEGY) != Z_OK)
        return Status(ErrorCode::runtime, "zlib has no memory");
    std::vector<std::byte> out;
    std::vector<std::byte> block(std::size_t{1} << 16);
    do {
        const std::size_t next = std::min(bytes.size(), step);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
        stream.avail_in = static_cast<uInt>(next);
        bytes = bytes.subspan(next);
        do {
            stream.next_out = reinterpret_cast<Bytef*>(block.data());
            stream.avail_out = static_cast<uInt>(block.size());
            deflate(&stream, bytes.empty() ? Z_FINISH : Z_NO_FLUSH);
            out.insert(out.end(), block.begin(),
                       block.end() - static_cast<std::ptrdiff_t>(stream.avail_out));
        } while (stream.avail_out == 0);
    } while (!bytes.empty());
    deflateEnd(&stream);
    return out;
}

std::string base64(std::span<const std::byte> bytes) {
    static constexpr char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three =
                three << 8 | (i + k < bytes.size() ? std::to_integer<unsigned>(bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : digits[three >> (18 - 6 * k) & 63];
    }
    return text;
}

} // namespace tessera
