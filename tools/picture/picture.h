// An 8-bit RGB picture to look at.
#pragma once

#include "format/status.h"
#include "tools/picture/tone_map.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

struct Picture {
    std::uint32_t width = 0, height = 0;
    std::vector<std::byte> rgb; // rows from the top

    std::byte* pixel(std::uint32_t x, std::uint32_t y) {
        return rgb.data() + (std::size_t{y} * width + x) * 3;
    }
    const std::byte* pixel(std::uint32_t x, std::uint32_t y) const {
        return rgb.data() + (std::size_t{y} * width + x) * 3;
    }
};

inline constexpr std::uint64_t max_sheet_pixels = 1u << 28;

Picture blank_picture(std::uint32_t width, std::uint32_t height, int grey);

// |a - b| times `amplify`, per channel. Precondition: both have the same size.
Picture difference_of(const Picture& a, const Picture& b, double amplify);

// The colours of a PNG. Errors: io, invalid_file, unsupported (grey, more than max_sheet_pixels).
Result<Picture> read_png(const std::string& path);

// Writes a PNG, which appears as `path` when it is complete. Errors: io, runtime.
Status write_png(const std::string& path, const Picture& picture);

} // namespace tessera
