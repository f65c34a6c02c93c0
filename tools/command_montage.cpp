#include "tools/command.h"
#include "tools/panels.h"
#include "tools/png_file.h"
#include "tools/texture_arguments.h"
#include "tools/texture_io.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace tessera {
namespace {

struct Arguments {
    std::vector<std::string> pictures, labels;
    std::string output;
    unsigned columns = 1, middle = 0;
    bool quiet = false;
};

Result<Picture> read_picture(const std::string& path) {
    const auto shape = read_png_shape(path);
    if (!shape.ok())
        return shape.status();
    if (shape->channels != 3)
        return Status(ErrorCode::unsupported, path + ": is not RGB");
    if (std::uint64_t{shape->width} * shape->height > max_sheet_pixels)
        return Status(ErrorCode::unsupported, path + ": is too large for a sheet");
    Picture picture = blank_picture(shape->width, shape->height, 0);
    TESSERA_TRY(read_png(path, *shape, shape->height, [&](std::uint32_t y, auto row) {
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

Status run(const Arguments& a) {
    if (std::filesystem::path(a.output).extension() != ".png")
        return {ErrorCode::bad_argument, a.output + ": a sheet is a .png"};
    if (!a.labels.empty() && a.labels.size() != a.pictures.size())
        return {ErrorCode::bad_argument, std::to_string(a.labels.size()) + " labels for " +
                                             std::to_string(a.pictures.size()) + " pictures"};
    TESSERA_TRY(check_output_path(a.output));
    std::vector<PanelRow> rows;
    for (std::size_t i = 0; i < a.pictures.size(); ++i) {
        const auto picture = read_picture(a.pictures[i]);
        if (!picture.ok())
            return picture.status();
        if (i % a.columns == 0)
            rows.emplace_back();
        rows.back().push_back(
            {a.labels.empty() ? std::filesystem::path(a.pictures[i]).stem().string() : a.labels[i],
             middle_of(*picture, a.middle)});
    }
    const auto sheet = lay_out(rows);
    if (!sheet.ok())
        return sheet.status().with_context(a.output);
    TESSERA_TRY(write_png(a.output, *sheet));
    if (!a.quiet)
        std::printf("%s: %u x %u pixels\n", a.output.c_str(), sheet->width, sheet->height);
    return {};
}

} // namespace

void add_montage_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, Arguments& a) {
        c.add_option("pictures", a.pictures, "8-bit RGB .png files, row by row")->required();
        c.add_option("-o,--output", a.output, "The .png to write")->required();
        c.add_option("--columns", a.columns, "Pictures in a row")
            ->check(CLI::Range(1u, 100u))
            ->capture_default_str();
        c.add_option("--label", a.labels,
                     "Text above a picture; once for each, in their order (their names)")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        c.add_option("--middle", a.middle,
                     "Only the middle of each, so many pixels wide and high; 0: all")
            ->check(CLI::Range(0u, 16384u))
            ->capture_default_str();
        c.add_flag("--quiet,-q", a.quiet, "No summary, errors only");
    };
    add_verb<Arguments>(app, chosen, "montage", "Set pictures side by side on one PNG",
                        "Examples:\n"
                        "  tessera montage a.png b.png --columns 2 -o both.png\n"
                        "  tessera montage v-1.png v-2.png --label front --label side "
                        "--middle 320 -o sheet.png",
                        declare, run);
}

} // namespace tessera
