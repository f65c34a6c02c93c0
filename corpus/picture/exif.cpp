#include "corpus/picture/exif.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

namespace tessera::corpus {
namespace {

constexpr std::string_view exif_mark("Exif\0\0", 6);
constexpr std::uint16_t orientation_tag = 0x0112;
constexpr std::size_t entry_bytes = 12;
constexpr std::uint64_t most_turned_bytes = 1ull << 30;

// A TIFF structure: numbers in the byte order that its first bytes state. 0 past its end.
class Tiff {
public:
    explicit Tiff(std::span<const std::byte> bytes) : bytes_(bytes) {
        big_endian_ = at(0) == 'M' && at(1) == 'M';
    }
    bool is_valid() const {
        return (big_endian_ || (at(0) == 'I' && at(1) == 'I')) && number(2, 2) == 42;
    }
    std::uint32_t number(std::size_t offset, std::size_t size) const {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < size; ++i)
            value = value << 8 | at(offset + (big_endian_ ? i : size - 1 - i));
        return value;
    }

private:
    std::uint32_t at(std::size_t i) const {
        return i < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[i]) : 0;
    }
    std::span<const std::byte> bytes_;
    bool big_endian_;
};

class TurnedPicture final : public PictureReader {
public:
    TurnedPicture(std::unique_ptr<PictureReader> picture, Orientation orientation)
        : picture_(std::move(picture)), orientation_(orientation) {
        shape_ = picture_->shape();
        notes_ = picture_->notes();
        if (swaps_axes())
            std::swap(shape_.width, shape_.height);
    }
    std::string attribute(const std::string& name) const override {
        return picture_->attribute(name);
    }

private:
    bool swaps_axes() const { return orientation_ >= Orientation::left_top; }

    Status read(SampleType type, std::uint32_t first, std::uint32_t last,
                const PictureRow& row) override {
        const PictureShape& from = picture_->shape();
        const std::size_t texel = from.channels * sample_bytes(type);
        const std::uint64_t bytes = std::uint64_t{from.width} * from.height * texel;
        if (bytes > most_turned_bytes)
            return {ErrorCode::unsupported, "a picture of " + std::to_string(bytes) +
                                                " bytes that EXIF turns; " +
                                                "only 1 GiB is turned"};
        std::vector<std::byte> all(bytes);
        std::uint64_t clamped = 0; // of all rows; said once
        TESSERA_TRY(picture_->read_rows(
            type, 0, from.height, [&](std::uint32_t y, std::span<const std::byte> samples) {
                clamped += picture_->clamped_in_row();
                std::ranges::copy(samples, all.begin() + static_cast<std::ptrdiff_t>(
                                                             std::size_t{y} * from.width * texel));
            }));
        std::vector<std::byte> line(shape_.width * texel);
        for (std::uint32_t y = first; y < last; ++y) {
            for (std::uint32_t x = 0; x < shape_.width; ++x)
                std::memcpy(&line[x * texel], &all[source_of(x, y) * texel], texel);
            clamped_in_row_ = y == 0 ? clamped : 0;
            row(y, line);
        }
        return {};
    }

    // The index in the file of the pixel that belongs at (x, y).
    std::size_t source_of(std::uint32_t x, std::uint32_t y) const {
        const PictureShape& from = picture_->shape();
        if (swaps_axes())
            std::swap(x, y);
        using enum Orientation;
        if (orientation_ == top_right || orientation_ == bottom_right ||
            orientation_ == right_bottom || orientation_ == left_bottom)
            x = from.width - 1 - x;
        if (orientation_ == bottom_right || orientation_ == bottom_left ||
            orientation_ == right_top || orientation_ == right_bottom)
            y = from.height - 1 - y;
        return std::size_t{y} * from.width + x;
    }

    std::unique_ptr<PictureReader> picture_;
    Orientation orientation_;
};

} // namespace

Orientation exif_orientation(std::span<const std::byte> segment) {
    const std::string_view text(reinterpret_cast<const char*>(segment.data()), segment.size());
    if (!text.starts_with(exif_mark))
        return Orientation::top_left;
    const Tiff tiff(segment.subspan(exif_mark.size()));
    const std::size_t directory = tiff.number(4, 4);
    if (!tiff.is_valid() || directory > segment.size())
        return Orientation::top_left;
    const std::size_t count = tiff.number(directory, 2);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t entry = directory + 2 + i * entry_bytes;
        if (tiff.number(entry, 2) != orientation_tag)
            continue;
        const std::uint32_t value = tiff.number(entry + 8, 2);
        return value >= 1 && value <= 8 ? static_cast<Orientation>(value) : Orientation::top_left;
    }
    return Orientation::top_left;
}

std::unique_ptr<PictureReader> turned(std::unique_ptr<PictureReader> picture,
                                      Orientation orientation) {
    if (orientation == Orientation::top_left)
        return picture;
    return std::make_unique<TurnedPicture>(std::move(picture), orientation);
}

} // namespace tessera::corpus
