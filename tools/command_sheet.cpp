#include "tools/command.h"
#include "tools/contact_sheet.h"
#include "tools/interrupt.h"
#include "tools/output_folders.h"
#include "tools/texture_arguments.h"
#include "tools/texture_io.h"

#include <filesystem>
#include <tuple>

namespace tessera {
namespace {

struct Arguments {
    std::string a, b, output;
    TextureArguments texture;
    SheetOptions sheet;
};

Status run(const Arguments& a) {
    if (std::filesystem::path(a.output).extension() != ".png")
        return {ErrorCode::bad_argument, a.output + ": a sheet is a .png"};
    TESSERA_TRY(check_output_path(a.output));
    const auto hints = make_hints(a.texture);
    if (!hints.ok())
        return hints.status();
    OpenedTexture first, second;
    if (a.b.empty()) {
        auto opened = open_texture(a.a, *hints);
        if (!opened.ok())
            return opened.status();
        first = std::move(*opened);
    } else {
        auto opened = open_two_textures(a.a, a.b, *hints);
        if (!opened.ok())
            return opened.status();
        std::tie(first, second) = std::move(*opened);
    }
    SheetOptions options = a.sheet;
    options.name_a = std::filesystem::path(a.a).filename().string();
    options.name_b = std::filesystem::path(a.b).filename().string();
    const auto source = interruptible(std::move(first.source));
    const auto picture = make_contact_sheet(*source, second.source.get(), options);
    if (!picture.ok())
        return picture.status();
    TESSERA_TRY(write_png(a.output, *picture));
    if (!a.texture.quiet)
        std::printf("%s: %u x %u pixels\n", a.output.c_str(), picture->width, picture->height);
    return {};
}

} // namespace

void add_sheet_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, Arguments& a) {
        c.add_option("a", a.a, "A texture; .tess also as a URL")->required();
        c.add_option("b", a.b, "A second one to show beside it, with the difference");
        c.add_option("-o,--output", a.output, "The .png to write")->required();
        c.add_option("--views", a.sheet.views, "How many views")
            ->check(CLI::Range(1u, 16u))
            ->capture_default_str();
        c.add_option("--angular", a.sheet.angular_images, "How many angular images")
            ->check(CLI::Range(0u, 32u))
            ->capture_default_str();
        c.add_option("--amplify", a.sheet.amplify, "Factor of the difference")
            ->check(CLI::Range(1.0, 255.0))
            ->capture_default_str();
        add_texture_options(c, a.texture);
    };
    add_verb<Arguments>(
        app, chosen, "sheet", "A PNG of some views and angular images",
        "Views are spread over s and t, angular images over u and v; half floats are shown as\n"
        "sRGB of x / (1 + x).\n\n"
        "Examples:\n"
        "  tessera sheet scene.exr scene.tess -o sheet.png\n"
        "  tessera sheet scene.tess -o sheet.png --views 5",
        declare, run);
}

} // namespace tessera
