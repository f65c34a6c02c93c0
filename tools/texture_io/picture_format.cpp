#include "tools/texture_io/picture_format.h"

#include "tools/texture_io/exr_writer.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace tessera {

using corpus::PictureKind;

constexpr int jpeg_quality = 95;

PictureKind picture_kind_of_name(std::string_view name) {
    const std::size_t dot = name.rfind('.');
    std::string ending(dot == std::string_view::npos ? "" : name.substr(dot));
    std::ranges::transform(ending, ending.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    constexpr std::pair<std::string_view, PictureKind> endings[] = {
        {".png", PictureKind::png},   {".jpg", PictureKind::jpeg}, {".jpeg", PictureKind::jpeg},
        {".exr", PictureKind::exr},   {".tif", PictureKind::tiff}, {".tiff", PictureKind::tiff},
        {".webp", PictureKind::webp}, {".ppm", PictureKind::pnm},  {".pgm", PictureKind::pnm},
        {".pnm", PictureKind::pnm},   {".pfm", PictureKind::pfm},  {".bmp", PictureKind::bmp},
        {".hdr", PictureKind::hdr},   {".tga", PictureKind::tga}};
    const auto* const known =
        std::ranges::find(endings, ending, &std::pair<std::string_view, PictureKind>::first);
    return known != std::end(endings) ? known->second : PictureKind::none;
}

std::string writable_picture_name(const std::string& name, SampleType type) {
    switch (picture_kind_of_name(name)) {
    case PictureKind::none:
    case PictureKind::png:
    case PictureKind::jpeg:
    case PictureKind::exr:
        return name;
    default:
        return name.substr(0, name.rfind('.')) + (traits_of(type).is_float ? ".exr" : ".png");
    }
}

Status check_picture_kind(PictureKind kind, SampleType type, std::uint8_t channels) {
    if (kind == PictureKind::exr)
        return {};
    if (kind != PictureKind::png && kind != PictureKind::jpeg)
        return {ErrorCode::unsupported, "pictures are written as .png, .jpg or .exr"};
    if (sample_bytes(type) != 1)
        return {ErrorCode::unsupported,
                "PNG and JPEG views hold 8 bits, this texture is half float; write EXR "
                "instead: x.exr, or --views-pattern 'view_t{t:3}_s{s:3}.exr'"};
    if (kind == PictureKind::jpeg && channels % 2 == 0)
        return {ErrorCode::unsupported, "JPEG holds no alpha; write PNG instead"};
    return {};
}

Result<std::vector<std::byte>> encode_picture(PictureKind kind, const PixelSize& size,
                                              SampleType type, std::span<const std::byte> samples) {
    TESSERA_TRY(check_picture_kind(kind, type, size.channels));
    if (kind == PictureKind::jpeg)
        return encode_jpeg(size, samples, jpeg_quality);
    return kind == PictureKind::png ? encode_png(size, samples) : encode_exr(size, type, samples);
}

} // namespace tessera
