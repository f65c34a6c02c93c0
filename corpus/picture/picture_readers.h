// What the readers of the kinds of pictures share. Their errors do not name the file, except for
// io.
#pragma once

#include "corpus/picture_file.h"

#include <string_view>

namespace tessera::corpus {

// A picture of 8-bit or 16-bit integers.
class IntegerReader : public PictureReader {
protected:
    Status read(SampleType type, std::uint32_t first, std::uint32_t last,
                const PictureRow& row) final;
    // Calls row() for y = 0..last-1 with samples of 8 bits or, if `deep`, of shape_.bits in the
    // machine's byte order.
    virtual Status decode(bool deep, std::uint32_t last, const PictureRow& row) = 0;
};

// A picture that is held whole.
struct HeldPicture {
    PictureShape shape;
    std::vector<std::byte> integers; // of shape.bits in the machine's byte order, or
    std::vector<float> floats;       // where shape.is_float
    std::vector<std::string> notes;  // PictureReader::notes()
};
std::unique_ptr<PictureReader> held(HeldPicture picture);

// Converts floats to `type`. Returns how many were beyond the range of halves and became +-65504.
// Infinities and NaN stay for halves.
std::uint64_t floats_to_samples(SampleType type, std::span<const float> floats, std::byte* samples);

Result<std::unique_ptr<PictureReader>> open_png(ByteSource& file);
Result<std::unique_ptr<PictureReader>> open_jpeg(ByteSource& file, Exif exif);
Result<Image> read_webp(std::span<const std::byte> file);
Result<Image> read_bmp(std::span<const std::byte> file);
Result<Image> read_tga(std::span<const std::byte> file);
Result<LightImage> read_hdr(std::span<const std::byte> file);
Result<HeldPicture> read_pnm(std::span<const std::byte> file); // PGM and PPM, also as text
Result<HeldPicture> read_pfm(std::span<const std::byte> file);
Result<std::unique_ptr<PictureReader>> open_tiff(ByteSource& file, Exif exif);

// Errors: unsupported, where a picture exceeds the limits of decode_image(); invalid_file, where it
// is empty.
Status check_size(std::uint64_t width, std::uint64_t height);

// Whether `mark` occurs in the file behind its first `begin` bytes. Searches from the end.
Result<bool> occurs_behind(ByteSource& file, std::uint64_t begin, std::string_view mark);

inline Status damaged(const std::string& why) {
    return {ErrorCode::invalid_file, "damaged " + why};
}
inline Status not_supported(const std::string& what) {
    return {ErrorCode::unsupported, "not supported: " + what + "; convert it to PNG"};
}

// A file in memory. A read past the end returns zeros and is remembered.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    bool ok() const { return ok_; }
    std::size_t left() const { return bytes_.size(); }
    // Little-endian; at most 4 bytes.
    std::uint32_t number(std::size_t bytes) {
        std::uint32_t value = 0, shift = 0;
        for (const std::byte b : take(bytes)) {
            value |= std::to_integer<std::uint32_t>(b) << shift;
            shift += 8;
        }
        return value;
    }
    // The next `count` bytes; none where fewer are left.
    std::span<const std::byte> take(std::size_t count) {
        ok_ = ok_ && count <= bytes_.size();
        const auto taken = bytes_.first(ok_ ? count : 0);
        bytes_ = bytes_.subspan(taken.size());
        return taken;
    }

private:
    std::span<const std::byte> bytes_;
    bool ok_ = true;
};

} // namespace tessera::corpus
