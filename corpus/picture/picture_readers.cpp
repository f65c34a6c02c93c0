#include "corpus/picture/picture_readers.h"

#include "corpus/exr_samples.h"

#include <algorithm>
#include <cmath>
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

class HeldReader final : public PictureReader {
public:
    explicit HeldReader(HeldPicture picture) : picture_(std::move(picture)) {
        shape_ = picture_.shape;
        notes_ = std::move(picture_.notes);
    }

private:
    Status read(SampleType type, std::uint32_t first, std::uint32_t last,
                const PictureRow& row) override {
        const std::size_t line = std::size_t{shape_.width} * shape_.channels;
        std::vector<std::byte> converted(line * sample_bytes(type));
        for (std::uint32_t y = first; y < last; ++y) {
            if (shape_.is_float)
                clamped_in_row_ = floats_to_samples(
                    type, std::span(picture_.floats).subspan(y * line, line), converted.data());
            else
                convert(type, y * line, line, converted);
            row(y, converted);
        }
        return {};
    }

    void convert(SampleType type, std::size_t first, std::size_t count,
                 std::span<std::byte> out) const {
        const std::size_t bytes = shape_.bits / 8;
        const auto row = std::span(picture_.integers).subspan(first * bytes, count * bytes);
        std::vector<std::uint16_t> halves(traits_of(type).is_float ? count : 0);
        if (!halves.empty()) {
            integers_to_halves(row, shape_.bits, halves);
            std::memcpy(out.data(), halves.data(), out.size());
        } else if (bytes == 1) {
            std::ranges::copy(row, out.begin());
        } else {
            for (std::size_t i = 0; i < count; ++i) {
                std::uint16_t value = 0;
                std::memcpy(&value, row.data() + 2 * i, 2);
                out[i] = static_cast<std::byte>((value + 128u) / 257);
            }
        }
    }

    HeldPicture picture_;
};

} // namespace

std::unique_ptr<PictureReader> held(HeldPicture picture) {
    return std::make_unique<HeldReader>(std::move(picture));
}

std::uint64_t floats_to_samples(SampleType type, std::span<const float> floats,
                                std::byte* samples) {
    constexpr float largest = 65504;
    std::uint64_t clamped = 0;
    std::vector<std::uint16_t> halves(floats.size());
    for (std::size_t i = 0; i < floats.size(); ++i) {
        const bool is_beyond = std::abs(floats[i]) > largest && std::isfinite(floats[i]);
        clamped += is_beyond ? 1 : 0;
        halves[i] = float_to_half(is_beyond ? std::copysign(largest, floats[i]) : floats[i]);
    }
    halves_to_samples(type, halves, samples);
    return traits_of(type).is_float ? clamped : 0;
}

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
