// Pictures of whatever kind as rows of samples: PNG, JPEG, EXR.
#pragma once

#include "format/byte_source.h"
#include "format/texture.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

enum class PictureKind { none, png, jpeg, exr };

// By the bytes that it begins with; none where they say nothing, or cannot be read.
PictureKind picture_kind_of(ByteSource& file);
// By the ending of a name, in either case.
PictureKind picture_kind_of_name(std::string_view name);

struct PictureShape {
    PictureKind kind = PictureKind::none;
    std::uint32_t width = 0, height = 0;
    std::uint8_t channels = 0; // 1..4, as those of a texture
    std::uint8_t bits = 8;     // that a sample has in the file: 8 or 16
    // The type that it is read as where nothing else is asked for: half16 for EXR.
    SampleType usual_type() const {
        return kind == PictureKind::exr ? SampleType::half16 : SampleType::unorm8;
    }
};

// Errors: io; invalid_file, also where a PNG or JPEG is cut off; unsupported.
Result<PictureShape> read_picture_shape(ByteSource& file);

// Calls row(y, samples) for rows first..last-1, counted from the top, with width * channels samples of
// `type`. Integers become parts of 1 as halves; halves and 16-bit integers the nearest of 8 bits. The
// picture must have this shape. Errors: those above; runtime, when interrupted.
Status read_picture_rows(ByteSource& file, const PictureShape& shape, SampleType type,
                         std::uint32_t first, std::uint32_t last,
                         const std::function<void(std::uint32_t, std::span<const std::byte>)>& row);

// A file's bytes. `samples`: all rows, of `type`; shape.bits does not matter. PNG and JPEG take unorm8 only, JPEG no alpha.
// Errors: unsupported, runtime.
Status check_picture_kind(PictureKind kind, SampleType type, std::uint8_t channels);
Result<std::vector<std::byte>> encode_picture(const PictureShape& shape, SampleType type,
                                              std::span<const std::byte> samples);

} // namespace tessera
