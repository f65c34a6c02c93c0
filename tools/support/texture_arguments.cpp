#include "tools/support/texture_arguments.h"

#include "tools/support/option_checks.h"

#include <tuple>

namespace tessera {

void add_fill_options(CLI::App& app, DecodeOptions& decode) {
    app.add_flag("--allow-partial", decode.allow_partial,
                 "Accept the beginning of a .tess, as from a broken download; coarser levels "
                 "(encode --layers) replace what is missing");
    app.add_flag("--allow-damaged", decode.allow_damaged,
                 "Replace damaged tiles by coarser levels or the background");
}

void add_threads_options(CLI::App& app, TextureArguments& a) {
    app.add_option("--threads", a.threads,
                   "Threads; 0 uses all cores. The result does not depend on it")
        ->check(CLI::Range(0u, 1024u))
        ->option_text("N");
    app.add_flag("--quiet,-q", a.quiet, "Print errors only: no progress, no summary")
        ->each([](const std::string&) { network_limits().quiet = true; });
}

void add_view_options(CLI::App& app, TextureArguments& a) {
    OptionGroup views(app, views_heading);
    views.option("--views-pattern", "TEXT", a.pattern,
                 "Names in the folder: {t} row, {s} column, {n} running number, {n:3} with three "
                 "digits, {n+1} counted from 1, * anything. Example: 'cam_{t:2}_{s:2}_*.png'");
    views.option("--order", "WORDS", a.order,
                 "How views are numbered: rows or columns, serpentine, bottom-up, right-left, "
                 "joined by commas. Default: rows from the top, in quilts from the bottom");
    views.option("--quilt", "CxR", a.quilt, "The picture holds the views in C columns and R rows");
}

void add_texture_options(CLI::App& app, TextureArguments& a) {
    OptionGroup input(app, "Inputs that do not describe themselves"), views(app, views_heading);
    input.option("--size", "UxVxSxT", a.size,
                 "Size of a raw input, or of a mosaic that does not state it");
    input.option("--type", "TYPE", a.type, "Sample type of the input: unorm8 or half16");
    input.option("--channels", "1..4", a.channels, "Channels of a .raw input", CLI::Range(1u, 4u));
    add_view_options(app, a);
    views.option("--grid", "CxR", a.grid,
                 "Columns and rows of cameras, for running numbers and quilts");
    views.option("--mosaic", "SxT", a.mosaic,
                 "The picture holds angular images, as of a lenslet camera");
    views.flag("--no-exif", a.no_exif, "Do not turn JPEG pictures as their EXIF metadata states");
    views.option("--layer", "NAME", a.layer,
                 "Layer of EXR pictures that have several, such as ViewLayer.Combined or left");
    views.option("--yuv-matrix", "bt601|bt709", a.yuv_matrix,
                 "Colours of a .y4m film. Default: bt709 from 720 lines on, else bt601",
                 CLI::IsMember({"bt601", "bt709"}));
    add_threads_options(app, a);
}

Result<ViewHints> make_view_hints(const TextureArguments& a) {
    ViewHints hints;
    hints.pattern = a.pattern;
    hints.exif = a.no_exif ? corpus::Exif::ignored : corpus::Exif::followed;
    hints.layer = a.layer;
    if (!a.yuv_matrix.empty())
        hints.yuv_matrix = a.yuv_matrix == "bt601" ? YuvMatrix::bt601 : YuvMatrix::bt709;
    for (const auto& [option, text, grid] :
         {std::tuple("--grid", &a.grid, &hints.grid), std::tuple("--quilt", &a.quilt, &hints.quilt),
          std::tuple("--mosaic", &a.mosaic, &hints.mosaic)})
        if (!text->empty()) {
            TESSERA_TRY_ASSIGN(*grid, parse_view_grid(*text).with_context(option));
        }
    if (hints.quilt && hints.mosaic)
        return Status(ErrorCode::bad_argument,
                      "--quilt and --mosaic: a picture is only one of them");
    if (!a.order.empty()) {
        TESSERA_TRY_ASSIGN(hints.order, parse_view_order(a.order).with_context("--order"));
    }
    return hints;
}

Result<TextureHints> make_hints(const TextureArguments& a) {
    TextureHints hints;
    hints.threads = a.threads;
    hints.decode = a.decode;
    TESSERA_TRY_ASSIGN(hints.views, make_view_hints(a));
    if (a.channels > 0)
        hints.channels = static_cast<std::uint8_t>(a.channels);
    if (!a.size.empty()) {
        TESSERA_TRY_ASSIGN(hints.size, parse_extent(a.size).with_context("--size"));
    }
    if (!a.type.empty()) {
        TESSERA_TRY_ASSIGN(hints.type, parse_sample_type(a.type).with_context("--type"));
    }
    return hints;
}

} // namespace tessera
