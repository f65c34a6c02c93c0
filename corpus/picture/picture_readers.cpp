#include "corpus/picture/picture_readers.h"

#include "corpus/exr_samples.h"

#include <algorithm>
#include <cstring>

namespace tessera::corpus {
namespace {

constexpr std::uint64_t most_picture_side = 1u << 14, most_picture_pixels = 1u << 26;

void integers_to_halves(std::span<const std::byte> row, unsigned bits,
                        std::span<std::uint16_t> out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (bits == 8) {
            out[i] = half_of_unorm8(std::to_integer<std::uint8_t>(row[i]));
            continue;
        }
        std::uint16_t value = 0;
        std::memcpy(&value, row.data() + 2 * i, 2);
        out[i] = float_to_half(static_cast<float>(value) / 65535.0f);
    }
}

} // namespace

Status check_size(std::uint64_t width, std::uint64_t height) {
    if (width == 0 || height == 0)
        return {ErrorCode::invalid_file, "the picture has no pixels"};
    if (width > most_picture_side || height > most_picture_side ||
        width * height > most_picture_pixels)
        return {ErrorCode::unsupported, "a picture of " + std::to_string(width) + "x" +
                                            std::to_string(height) + " is too large"};
    return {};
}

Result<bool> occurs_behind(ByteSource& file, std::uint64_t begin, std::string_view mark) {
    constexpr std::uint64_t piece = 1 << 16;
    std::string text;
    for (std::uint64_t end = file.size(); end > begin; end -= std::min(end - begin, piece)) {
        const std::uint64_t from = end - std::min(end - begin, piece);
        // A mark may lie across the border of two pieces.
        text.resize(std::min(end + mark.size() - 1, file.size()) - from);
        TESSERA_TRY(file.read(from, std::as_writable_bytes(std::span(text))));
        if (text.find(mark) != std::string::npos)
            return true;
    }
    return false;
}

Status IntegerReader::read(SampleType type, std::uint32_t first, std::uint32_t last,
                           const PictureRow& row) {
    const bool halves = traits_of(type).is_float;
    std::vector<std::uint16_t> converted(halves ? std::size_t{shape_.width} * shape_.channels : 0);
    return decode(halves, last, [&](std::uint32_t y, std::span<const std::byte> samples) {
        if (y < first)
            return;
        if (halves)
            integers_to_halves(samples, shape_.bits, converted);
        row(y, halves ? std::as_bytes(std::span(converted)) : samples);
    });
}

} // namespace tessera::corpus
