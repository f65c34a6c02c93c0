#include "tools/picture/picture_grid.h"

#include "tools/picture/panels.h"
#include "tools/picture/png_file.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace tessera {
namespace {

Result<Picture> read_picture(const std::string& path) {
    TESSERA_TRY_ASSIGN(const auto shape, read_png_shape(path));
    if (shape.channels != 3)
        return Status(ErrorCode::unsupported, path + ": is not RGB");
    if (std::uint64_t{shape.width} * shape.height > max_sheet_pixels)
        return Status(ErrorCode::unsupported, path + ": is too large for a sheet");
    Picture picture = blank_picture(shape.width, shape.height, 0);
    TESSERA_TRY(read_png(path, shape, shape.height, [&](std::uint32_t y, auto row) {
        std::memcpy(picture.pixel(0, y), row.data(), row.size());
    }));
    return picture;
}

// The middle of it, at most `side` pixels wide and high; all of it for 0.
Picture middle_of(const Picture& picture, std::uint32_t side) {
    const std::uint32_t width = side == 0 ? picture.width : std::min(side, picture.width);
    const std::uint32_t height = side == 0 ? picture.height : std::min(side, picture.height);
    Picture part = blank_picture(width, height, 0);
    for (std::uint32_t y = 0; y < height; ++y)
        std::memcpy(part.pixel(0, y),
                    picture.pixel((picture.width - width) / 2, (picture.height - height) / 2 + y),
                    std::size_t{width} * 3);
    return part;
}

} // namespace

Result<Picture> make_picture_grid(std::span<const std::string> paths, const GridOptions& options) {
    if (!options.labels.empty() && options.labels.size() != paths.size())
        return Status(ErrorCode::bad_argument, std::to_string(options.labels.size()) +
                                                   " labels for " + std::to_string(paths.size()) +
                                                   " pictures");
    std::vector<PanelRow> rows;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        TESSERA_TRY_ASSIGN(const auto picture, read_picture(paths[i]));
        if (i % options.columns == 0)
            rows.emplace_back();
        rows.back().push_back({options.labels.empty()
                                   ? std::filesystem::path(paths[i]).stem().string()
                                   : options.labels[i],
                               middle_of(picture, options.middle)});
    }
    return lay_out(rows);
}

} // namespace tessera
