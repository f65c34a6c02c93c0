#include "tools/texture_io/picture_format.h"

#include "format/samples.h"
#include "tools/picture/jpeg_file.h"
#include "tools/picture/png_file.h"
#include "tools/texture_io/exr_picture.h"
#include "tools/texture_io/exr_samples.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace tessera {
namespace {

constexpr int jpeg_quality = 95;
constexpr std::uint64_t exr_rows_bytes = 1 << 22; // read at once

using RowFunction = std::function<void(std::uint32_t, std::span<const std::byte>)>;

PngShape png_shape(const PictureShape& shape) {
    return {shape.width, shape.height, shape.channels, shape.bits};
}

JpegShape jpeg_shape(const PictureShape& shape) {
    return {shape.width, shape.height, shape.channels};
}

// 8 bits, or 16 in the machine's order, as halves.
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

Status read_integer_rows(ByteSource& file, const PictureShape& shape, SampleType type,
                         std::uint32_t first, std::uint32_t last, const RowFunction& row) {
    const bool halves = type == SampleType::half16;
    std::vector<std::uint16_t> converted(halves ? std::size_t{shape.width} * shape.channels : 0);
    const auto take = [&](std::uint32_t y, std::span<const std::byte> samples) {
        if (y < first)
            return;
        if (halves)
            integers_to_halves(samples, shape.bits, converted);
        row(y, halves ? std::as_bytes(std::span(converted)) : samples);
    };
    if (shape.kind == PictureKind::jpeg)
        return read_jpeg(file, jpeg_shape(shape), last, take);
    return read_png(file, png_shape(shape), last, take,
                    halves ? PngSamples::as_they_are : PngSamples::eight);
}

Status read_exr_rows(ByteSource& file, const PictureShape& shape, SampleType type,
                     std::uint32_t first, std::uint32_t last, const RowFunction& row) {
    ExrPicture picture(file);
    TESSERA_TRY(picture.open(0));
    if (picture.width() != shape.width || picture.height() != shape.height ||
        picture.channels() != shape.channels)
        return {ErrorCode::invalid_file, picture.path() + ": changed while it was read"};
    const std::size_t line = std::size_t{shape.width} * shape.channels;
    const auto step = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(exr_rows_bytes / (2 * line), 1, shape.height));
    std::vector<std::uint16_t> halves;
    std::vector<std::byte> samples(line * sample_bytes(type));
    for (std::uint32_t y = first; y < last; y += step) {
        const std::uint32_t end = std::min(last, y + step);
        halves.resize((end - y) * line);
        TESSERA_TRY(picture.read_lines(y, end, halves));
        for (std::uint32_t i = y; i < end; ++i) {
            halves_to_samples(type, std::span(halves).subspan((i - y) * line, line),
                              samples.data());
            row(i, samples);
        }
    }
    return {};
}

} // namespace

PictureKind picture_kind_of(ByteSource& file) {
    constexpr unsigned char png[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    constexpr unsigned char exr[] = {0x76, 0x2f, 0x31, 0x01, 2}; // and its version
    constexpr unsigned char jpeg[] = {0xff, 0xd8, 0xff};
    std::array<unsigned char, 8> begin{};
    const std::size_t length = std::min<std::uint64_t>(begin.size(), file.size());
    if (!file.read(0, std::as_writable_bytes(std::span(begin)).first(length)).ok())
        return PictureKind::none;
    const auto begins_with = [&](std::span<const unsigned char> magic) {
        return length >= magic.size() &&
               std::ranges::equal(magic, std::span(begin).first(magic.size()));
    };
    return begins_with(png)    ? PictureKind::png
           : begins_with(jpeg) ? PictureKind::jpeg
           : begins_with(exr)  ? PictureKind::exr
                               : PictureKind::none;
}

PictureKind picture_kind_of_name(std::string_view name) {
    const std::size_t dot = name.rfind('.');
    std::string ending(dot == std::string_view::npos ? "" : name.substr(dot));
    std::ranges::transform(ending, ending.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending == ".png"                        ? PictureKind::png
           : ending == ".jpg" || ending == ".jpeg" ? PictureKind::jpeg
           : ending == ".exr"                      ? PictureKind::exr
                                                   : PictureKind::none;
}

Result<PictureShape> read_picture_shape(ByteSource& file) {
    const PictureKind kind = picture_kind_of(file);
    if (kind == PictureKind::png) {
        TESSERA_TRY_ASSIGN(const PngShape png, read_png_shape(file));
        return PictureShape{kind, png.width, png.height, png.channels, png.bits};
    }
    if (kind == PictureKind::jpeg) {
        TESSERA_TRY_ASSIGN(const JpegShape jpeg, read_jpeg_shape(file));
        return PictureShape{kind, jpeg.width, jpeg.height, jpeg.channels, 8};
    }
    if (kind == PictureKind::none)
        return Status(ErrorCode::invalid_file, file.name() + ": not a PNG, JPEG or EXR picture");
    ExrPicture picture(file);
    TESSERA_TRY(picture.open(0));
    if (picture.width() > max_extent || picture.height() > max_extent)
        return Status(ErrorCode::unsupported, picture.path() + ": is too large");
    return PictureShape{kind, static_cast<std::uint32_t>(picture.width()),
                        static_cast<std::uint32_t>(picture.height()), picture.channels(), 16};
}

Status read_picture_rows(ByteSource& file, const PictureShape& shape, SampleType type,
                         std::uint32_t first, std::uint32_t last, const RowFunction& row) {
    if (picture_kind_of(file) != shape.kind)
        return {ErrorCode::invalid_file, file.name() + ": changed while it was read"};
    if (shape.kind == PictureKind::exr)
        return read_exr_rows(file, shape, type, first, last, row);
    return read_integer_rows(file, shape, type, first, last, row);
}

Status check_picture_kind(PictureKind kind, SampleType type, std::uint8_t channels) {
    if (kind == PictureKind::exr)
        return {};
    if (type != SampleType::unorm8)
        return {ErrorCode::unsupported,
                "PNG and JPEG views hold 8 bits, this texture is half float; write EXR "
                "instead: x.exr, or --views-pattern 'view_t{t:3}_s{s:3}.exr'"};
    if (kind == PictureKind::jpeg && channels % 2 == 0)
        return {ErrorCode::unsupported, "JPEG holds no alpha; write PNG instead"};
    return {};
}

Result<std::vector<std::byte>> encode_picture(const PictureShape& shape, SampleType type,
                                              std::span<const std::byte> samples) {
    TESSERA_TRY(check_picture_kind(shape.kind, type, shape.channels));
    if (shape.kind == PictureKind::jpeg)
        return encode_jpeg(jpeg_shape(shape), samples, jpeg_quality);
    if (shape.kind == PictureKind::png)
        return encode_png({shape.width, shape.height, shape.channels}, samples);
    std::vector<std::uint16_t> halves(std::size_t{shape.width} * shape.height * shape.channels);
    samples_to_halves(type, samples.data(), halves);
    return encode_exr(shape.width, shape.height, shape.channels, halves);
}

} // namespace tessera
