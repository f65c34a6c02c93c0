#include "tools/picture/picture.h"

#include "corpus/picture_file.h"
#include "format/output_file.h"
#include "tools/picture/picture_encoders.h"
#include "tools/support/output_folders.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {

Picture blank_picture(std::uint32_t width, std::uint32_t height, int grey) {
    return {width, height,
            std::vector<std::byte>(std::size_t{width} * height * 3, std::byte(grey))};
}

Picture difference_of(const Picture& a, const Picture& b, double amplify) {
    Picture out = a;
    for (std::size_t i = 0; i < out.rgb.size(); ++i) {
        const int d = std::to_integer<int>(a.rgb[i]) - std::to_integer<int>(b.rgb[i]);
        out.rgb[i] = std::byte(static_cast<int>(std::min(255.0, std::abs(d) * amplify + 0.5)));
    }
    return out;
}

Result<Picture> read_png(const std::string& path) {
    TESSERA_TRY_ASSIGN(const auto file, open_file(path));
    TESSERA_TRY_ASSIGN(const auto reader, corpus::open_picture_file(*file));
    const corpus::PictureShape& shape = reader->shape();
    if (shape.kind != corpus::PictureKind::png)
        return Status(ErrorCode::invalid_file, path + ": not a PNG picture");
    if (shape.channels < 3)
        return Status(ErrorCode::unsupported, path + ": is not RGB");
    if (std::uint64_t{shape.width} * shape.height > max_sheet_pixels)
        return Status(ErrorCode::unsupported, path + ": is too large for a sheet");
    Picture picture = blank_picture(shape.width, shape.height, 0);
    TESSERA_TRY(reader->read_rows(
        SampleType::unorm8, 0, shape.height, [&](std::uint32_t y, std::span<const std::byte> row) {
            for (std::uint32_t x = 0; x < shape.width; ++x)
                std::copy_n(&row[std::size_t{x} * shape.channels], 3, picture.pixel(x, y));
        }));
    return picture;
}

Status write_png(const std::string& path, const Picture& picture) {
    TESSERA_TRY_ASSIGN(
        const auto png,
        encode_png({picture.width, picture.height, 3}, picture.rgb).with_context(path));
    TESSERA_TRY(make_parent_folders(path));
    TESSERA_TRY_ASSIGN(auto file, OutputFile::create(path));
    TESSERA_TRY(file.append(png));
    return file.commit();
}

} // namespace tessera
