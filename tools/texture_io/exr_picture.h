// The pixels of one EXR picture as halves: what a mosaic and a view are read through.
#pragma once

#include "tools/texture_io/exr_stream.h"

#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// Scanline and tiled pictures of any compression; FLOAT and UINT channels become half. Used by one
// thread at a time; `bytes` outlive it.
class ExrPicture {
public:
    explicit ExrPicture(ByteSource& bytes) : path_(bytes.name()), stream_(bytes) {}

    // Errors: io, invalid_file (no R,G,B[,A] or Y[,A]), unsupported (deep, several parts, subsampled
    // channels, lines too long). `threads`: of OpenEXR's own; 0: the caller's.
    Status open(unsigned threads);

    const std::string& path() const { return path_; }
    std::uint64_t width() const { return width_; }   // pixels
    std::uint64_t height() const { return height_; } // pixels
    std::uint8_t channels() const { return static_cast<std::uint8_t>(names_.size()); }
    // A text of the header; "" where it has none of this name.
    std::string attribute(const std::string& name) const;

    // Lines y0..y1-1 into `halves`, channels() of them a pixel. Precondition: inside the picture.
    Status read_lines(std::uint64_t y0, std::uint64_t y1, std::span<std::uint16_t> halves);

private:
    Status open_unguarded(unsigned threads);
    std::string path_;
    ExrInput stream_;
    std::optional<Imf::MultiPartInputFile> file_;
    std::optional<Imf::InputPart> part_;
    std::vector<std::string> names_; // of channels, in our order
    std::uint64_t width_ = 0, height_ = 0;
    int left_ = 0, top_ = 0;
};

// A file's bytes: a scanline picture with ZIP compression of `halves`, rows from the top. Errors: runtime.
Result<std::vector<std::byte>> encode_exr(std::uint32_t width, std::uint32_t height,
                                          std::uint8_t channels,
                                          std::span<const std::uint16_t> halves);

} // namespace tessera
