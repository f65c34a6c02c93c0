// Reads pictures: row by row as views, whole as textures of models, and as light.
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

// `pnm` is PGM or PPM, `pfm` their sibling of floats.
enum class PictureKind { none, png, jpeg, exr, hdr, webp, bmp, pnm, pfm, tiff, tga };

// Detected from the first bytes, and TGA, which has no signature there, from its footer or its name.
// `none` for other files and for files that cannot be read.
PictureKind picture_kind_of(ByteSource& file);

struct PictureShape {
    PictureKind kind = PictureKind::none;
    std::uint32_t width = 0, height = 0; // pixels
    std::uint8_t channels = 0;           // 1..4: grey, grey + alpha, RGB, RGB + alpha
    std::uint8_t bits = 8;               // 8 or 16 per sample in the file; 16 for all floats
    bool is_float = false;               // the samples may lie outside 0..1
    bool operator==(const PictureShape&) const = default;
    // half16 for floats, else unorm8.
    SampleType usual_type() const { return is_float ? SampleType::half16 : SampleType::unorm8; }
};

// Whether pictures are turned upright as their EXIF metadata states.
enum class Exif { ignored, followed };

struct PictureOptions {
    unsigned threads = 0; // of OpenEXR; 0: none of its own
    Exif exif = Exif::followed;
    // Of an EXR picture, as "ViewLayer.Combined" or its end, "Combined"; "": the only one with
    // colours, or the channels without a layer.
    std::string layer{};
};

using PictureRow = std::function<void(std::uint32_t y, std::span<const std::byte> samples)>;

// An open picture. Holds a few rows of PNG, JPEG and EXR, or all of it where PNG is interlaced or
// JPEG progressive, and all of other kinds. Use by one thread at a time.
class PictureReader {
public:
    virtual ~PictureReader() = default;
    const PictureShape& shape() const { return shape_; }

    // Calls row(y, samples) for y = first..last-1, counted from the top, with width * channels
    // samples of `type`. Conversions round to the nearest value; unorm8 stands for 0..1, and numbers
    // beyond the range of halves become +-65504. PNG and JPEG decode from the top each time.
    // Precondition: last <= height. Errors: those of open_picture_file().
    Status read_rows(SampleType type, std::uint32_t first, std::uint32_t last,
                     const PictureRow& row);
    // A text attribute of an EXR header; "" where there is none.
    virtual std::string attribute(const std::string&) const { return {}; }
    // What the file states and the reader does not follow, such as a colour profile.
    const std::vector<std::string>& notes() const { return notes_; }
    // How many samples of the last row were beyond the range of halves. To be called in row().
    std::uint64_t clamped_in_row() const { return clamped_in_row_; }

protected:
    virtual Status read(SampleType type, std::uint32_t first, std::uint32_t last,
                        const PictureRow& row) = 0;
    PictureShape shape_;
    std::vector<std::string> notes_;
    std::uint64_t clamped_in_row_ = 0;

private:
    friend Result<std::unique_ptr<PictureReader>> open_picture_file(ByteSource&,
                                                                    const PictureOptions&);
    std::string name_; // of the file; empty: errors have no name
};

// Reads the header and looks for the end of the file. PNG: palettes and transparent colours are
// resolved, fewer than 8 bits become 8, gamma is ignored. JPEG: CMYK becomes RGB; damage that other
// programs show as grey is an error; turning it upright holds all of it in memory. EXR: the display
// window, 0 outside the data window; scanlines or the finest level of tiles; R,G,B[,A] or Y[,A] or
// Y,RY,BY[,A] or X,Y,Z (CIE) of any type; of a layer that options.layer names, any one to four
// channels. PGM, PPM, PFM, TIFF, WebP, BMP and Radiance HDR: at most 2^14 pixels a side and 2^26 in
// all. Colours keep the primaries of the file, except that XYZ becomes RGB with those of sRGB.
// `file` must outlive the reader. Errors name the file: io, invalid_file, unsupported, bad_argument
// (a layer that the file does not have), runtime (memory).
Result<std::unique_ptr<PictureReader>> open_picture_file(ByteSource& file,
                                                         const PictureOptions& options = {});

// 8-bit RGBA, rows from the top.
struct Image {
    std::uint32_t width = 0, height = 0;
    std::vector<std::array<std::uint8_t, 4>> texels;
};

// Decodes a picture of at most 2^14 pixels a side and 2^26 in all: PNG, JPEG, WebP, BMP, TGA, PGM,
// PPM, TIFF, Radiance HDR or PFM. The light of the last two becomes sRGB, and JPEG is turned upright
// as its EXIF metadata states.
// Errors, which name no file: invalid_file; unsupported (too large, another kind of picture).
Result<Image> decode_image(std::span<const unsigned char> bytes);

// Linear light, rows from the top.
struct LightImage {
    std::uint32_t width = 0, height = 0;
    std::vector<glm::vec3> texels; // RGB
};

// Reads a Radiance HDR, an EXR or a PFM picture of the same limits. Exposure is not applied. Colours
// become RGB with the primaries of sRGB, by the chromaticities of an EXR. `layer`: as in
// PictureOptions. Errors name the file: those of open_picture_file().
Result<LightImage> read_light_image(ByteSource& file, const std::string& layer = "");

} // namespace tessera::corpus
