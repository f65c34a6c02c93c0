#include "tools/support/texture_arguments.h"

#include <tuple>

namespace tessera {
namespace {

constexpr const char* input_group = "Inputs that do not describe themselves";
constexpr const char* views_group = "Folders of views, quilts and mosaics";

} // namespace

void add_fill_options(CLI::App& app, DecodeOptions& decode) {
    app.add_flag("--allow-partial", decode.allow_partial,
                 "Accept the beginning of a .tess, such as a broken download; coarser levels "
                 "replace what is missing (encode --layers stores them first)");
    app.add_flag("--allow-damaged", decode.allow_damaged,
                 "Replace damaged tiles of a .tess by coarser levels or by the background");
}

void add_threads_options(CLI::App& app, TextureArguments& a) {
    app.add_option("--threads", a.threads, "Threads; 0 uses all cores. The result is the same")
        ->check(CLI::Range(0u, 1024u))
        ->option_text("N");
    app.add_flag("--quiet,-q", a.quiet, "Print errors only: no progress, no summary")
        ->each([](const std::string&) { network_limits().quiet = true; });
}

void add_view_options(CLI::App& app, TextureArguments& a) {
    app.add_option("--views-pattern", a.pattern,
                   "Names of a folder's views: {t} is the row, {s} the column, {n} a running "
                   "number ({n:3} with three digits), * anything: 'cam_{t:2}_{s:2}_*.png'")
        ->option_text("TEXT")
        ->group(views_group);
    app.add_option("--order", a.order,
                   "How running numbers and quilts traverse the cameras: rows or columns, "
                   "serpentine, bottom-up, right-left, joined by commas. Default: row by row from "
                   "the top left, quilts from the bottom left")
        ->option_text("WORDS")
        ->group(views_group);
    app.add_option("--quilt", a.quilt,
                   "The picture holds the views side by side, in C columns and R rows")
        ->option_text("CxR")
        ->group(views_group);
}

void add_texture_options(CLI::App& app, TextureArguments& a) {
    app.add_option("--size", a.size,
                   "Size of a raw input, or of a mosaic that does not state its own")
        ->option_text("UxVxSxT")
        ->group(input_group);
    app.add_option("--type", a.type, "Sample type of the input: unorm8 or half16")
        ->option_text("TYPE")
        ->group(input_group);
    app.add_option("--channels", a.channels, "Channels of a .raw input")
        ->check(CLI::Range(1u, 4u))
        ->option_text("1..4")
        ->group(input_group);
    add_view_options(app, a);
    app.add_option("--grid", a.grid,
                   "Columns and rows of cameras, for running numbers and for a quilt's views")
        ->option_text("CxR")
        ->group(views_group);
    app.add_option("--mosaic", a.mosaic,
                   "The picture holds angular images of SxT pixels, as a lenslet camera takes it")
        ->option_text("SxT")
        ->group(views_group);
    add_threads_options(app, a);
}

Result<ViewHints> make_view_hints(const TextureArguments& a) {
    ViewHints hints;
    hints.pattern = a.pattern;
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
