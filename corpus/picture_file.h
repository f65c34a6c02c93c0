// Reads pictures: PNG, JPEG and EXR row by row, those and WebP, BMP and TGA as textures of models,
// Radiance HDR and EXR as light.
//
// The readers expect hostile files. They check sizes before they allocate, refuse what is damaged
// or cut short, and bound their work by the bytes of the file and by the limits below.
#pragma once

#include "format/byte_source.h"
#include "format/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tessera::corpus {

enum class PictureKind { none, png, jpeg, exr, hdr, webp, bmp };

// Detected from the first bytes. `none` for other files, also for TGA, which has no signature, and
// for files that cannot be read.
PictureKind picture_kind_of(ByteSource& file);

struct PictureShape {
    PictureKind kind = PictureKind::none;
    std::uint32_t width = 0, height = 0; // pixels
    std::uint8_t channels = 0;           // 1..4: grey, grey + alpha, RGB, RGB + alpha
    std::uint8_t bits = 8;               // 8 or 16 per sample in the file; 16 for all EXR pictures
    bool operator==(const PictureShape&) const = default;
    // The type that loses least: half16 for EXR, unorm8 for PNG and JPEG.
    SampleType usual_type() const {
        return kind == PictureKind::exr ? SampleType::half16 : SampleType::unorm8;
    }
};

// Whether pictures are turned upright as their EXIF metadata states.
enum class Exif { ignored, followed };

using PictureRow = std::function<void(std::uint32_t y, std::span<const std::byte> samples)>;

// An open PNG, JPEG or EXR picture. Holds a few rows of it, or all of it where PNG is interlaced or
// JPEG progressive. Use by one thread at a time.
class PictureReader {
public:
    virtual ~PictureReader() = default;
    const PictureShape& shape() const { return shape_; }

    // Calls row(y, samples) for y = first..last-1, counted from the top, with width * channels
    // samples of `type`. Conversions round to the nearest value; unorm8 stands for 0..1. PNG and
    // JPEG decode from the top each time. Precondition: last <= height. Errors: those of
    // open_picture_file().
    Status read_rows(SampleType type, std::uint32_t first, std::uint32_t last,
                     const PictureRow& row);
    // A text attribute of an EXR header; "" where there is none.
    virtual std::string attribute(const std::string&) const { return {}; }

protected:
    virtual Status read(SampleType type, std::uint32_t first, std::uint32_t last,
                        const PictureRow& row) = 0;
    PictureShape shape_;

private:
    friend Result<std::unique_ptr<PictureReader>> open_picture_file(ByteSource&, unsigned, Exif);
    std::string name_; // of the file; empty: errors have no name
};

// Reads the header and looks for the end of the file. PNG: palettes and transparent colours are
// resolved, fewer than 8 bits become 8, gamma is ignored. JPEG: CMYK becomes RGB; damage that other
// programs show as grey is an error; `exif` says whether it is turned upright, which holds all of
// it in memory. EXR: the display window, 0 outside the data window; scanlines or tiles, R,G,B[,A]
// or Y[,A] or Y,RY,BY[,A] of any type, one part. `threads`: of OpenEXR, 0 for none of its own.
// `file` must outlive the reader. Errors name the file: io, invalid_file, unsupported, runtime
// (memory).
Result<std::unique_ptr<PictureReader>> open_picture_file(ByteSource& file, unsigned threads = 0,
                                                         Exif exif = Exif::followed);

// 8-bit RGBA, rows from the top.
struct Image {
    std::uint32_t width = 0, height = 0;
    std::vector<std::array<std::uint8_t, 4>> texels;
};

// Decodes a PNG, JPEG, WebP, BMP, TGA or Radiance HDR picture of at most 2^14 pixels a side and 2^26
// in all. The light of HDR becomes sRGB, and JPEG is turned upright as its EXIF metadata states.
// Errors, which name no file: invalid_file; unsupported (too large, another kind of picture).
Result<Image> decode_image(std::span<const unsigned char> bytes);

// Linear light, rows from the top.
struct LightImage {
    std::uint32_t width = 0, height = 0;
    std::vector<glm::vec3> texels; // RGB
};

// Reads a Radiance HDR or an EXR picture of the same limits. Exposure is not applied; XYZ becomes
// RGB with the primaries of sRGB. Errors name the file: io, invalid_file, unsupported, runtime.
Result<LightImage> read_light_image(ByteSource& file);

} // namespace tessera::corpus
