#include "tools/picture/picture.h"

#include "format/output_file.h"
#include "tools/picture/png_file.h"
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
