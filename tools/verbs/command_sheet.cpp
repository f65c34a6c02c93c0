#include "format/output_file.h"
#include "tools/picture/sheets.h"
#include "tools/support/fill_text.h"
#include "tools/support/interrupt.h"
#include "tools/support/option_checks.h"
#include "tools/support/texture_arguments.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"

#include <algorithm>
#include <filesystem>
#include <tuple>

namespace tessera {
namespace {

struct SheetCommand {
    std::vector<std::string> inputs;
    std::string output;
    TextureArguments texture;
    SheetOptions sheet;
    GridOptions grid;
};

bool is_png_file(const std::string& path) {
    return to_path(path).extension() == ".png" && !std::filesystem::is_directory(to_path(path));
}

// Appends to `remark` which parts of the textures were missing and had to be filled.
Result<Picture> sheet_of_textures(const SheetCommand& a, std::string& remark) {
    if (a.inputs.size() > 2)
        return Status(ErrorCode::bad_argument,
                      "a sheet shows at most two textures, or any number of .png files");
    TESSERA_TRY_ASSIGN(const auto hints, make_hints(a.texture));
    SheetOptions options = a.sheet;
    options.name_a = to_path(a.inputs[0]).filename().string();
    OpenedTexture first, second;
    if (a.inputs.size() == 1) {
        auto opened = open_texture(a.inputs[0], hints);
        if (!opened.ok())
            return with_partial_hint(opened.status(), a.inputs[0], hints.decode);
        first = std::move(*opened);
    } else {
        options.name_b = to_path(a.inputs[1]).filename().string();
        auto opened = open_two_textures(a.inputs[0], a.inputs[1], hints);
        if (!opened.ok())
            return with_partial_hint(opened.status(), a.inputs[0], a.inputs[1], hints.decode);
        std::tie(first, second) = std::move(*opened);
    }
    const auto source = interruptible(std::move(first.source));
    TESSERA_TRY_ASSIGN(auto sheet, make_contact_sheet(*source, second.source.get(), options));
    for (const Decoder* decoder : {first.decoder, second.decoder})
        if (decoder != nullptr)
            remark += fill_text(*decoder, "  ");
    return sheet;
}

Status run(const SheetCommand& a) {
    if (to_path(a.output).extension() != ".png")
        return {ErrorCode::bad_argument, a.output + ": a sheet is a .png"};
    TESSERA_TRY(check_output_path(a.output));
    const bool pictures = std::all_of(a.inputs.begin(), a.inputs.end(), is_png_file);
    std::string remark;
    TESSERA_TRY_ASSIGN(const auto picture, pictures ? make_picture_grid(a.inputs, a.grid)
                                                    : sheet_of_textures(a, remark));
    TESSERA_TRY(write_png(a.output, picture));
    if (!a.texture.quiet)
        std::printf("%s: %u x %u pixels\n%s", a.output.c_str(), picture.width, picture.height,
                    remark.c_str());
    return {};
}

} // namespace

void add_sheet_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, SheetCommand& a) {
        c.add_option("inputs", a.inputs,
                     "One texture (.tess also as a URL), or two to show with their difference; or "
                     "8-bit RGB .png files")
            ->required();
        c.add_option("-o,--output", a.output, "The .png to write")->required();
        c.add_option("--views", a.sheet.views,
                     "Number of views, spread over s and t. Default: " +
                         std::to_string(a.sheet.views))
            ->check(CLI::Range(1u, 16u))
            ->option_text("1..16");
        c.add_option("--angular", a.sheet.angular_images,
                     "Number of angular images, spread over u and v. Default: " +
                         std::to_string(a.sheet.angular_images))
            ->check(CLI::Range(0u, 32u))
            ->option_text("0..32");
        c.add_option("--amplify", a.sheet.amplify, "Factor of the difference. Default: 8")
            ->check(CLI::Range(1.0, 255.0))
            ->option_text("1..255");
        add_fill_options(c, a.texture.decode);
        OptionGroup pictures(c, "Sheets of .png files");
        pictures.option("--columns", "1..100", a.grid.columns,
                        "Pictures in a row. Default: " + std::to_string(a.grid.columns),
                        CLI::Range(1u, 100u));
        pictures
            .option("--label", "TEXT", a.grid.labels,
                    "Text above a picture, once per picture. Default: their names")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        pictures.option("--middle", "N", a.grid.middle,
                        "Show only the middle, this many pixels wide and high; 0 shows all",
                        CLI::Range(0u, 16384u));
        add_texture_options(c, a.texture);
        add_network_options(c);
    };
    add_verb<SheetCommand>(
        app, chosen, "sheet", "A PNG of some views and angular images, or of pictures side by side",
        "Half floats are shown as sRGB of x / (1 + x).\n\n"
        "Examples:\n"
        "  tessera sheet scene.exr scene.tess -o sheet.png\n"
        "  tessera sheet scene.tess -o sheet.png --views 5\n"
        "  tessera sheet v-1.png v-2.png --label front --label side --columns 2 -o both.png",
        declare, run);
}

} // namespace tessera
