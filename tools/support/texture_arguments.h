// Options that say what a texture is, shared by the verbs that read one.
#pragma once

#include "tools/support/network_limits.h"
#include "tools/support/parse.h"
#include "tools/support/texture_hints.h"

#include <CLI/CLI.hpp>
#include <string>
#include <tuple>

namespace tessera {

struct TextureArguments {
    std::string size, type;
    std::string pattern, grid, quilt, mosaic, order; // of views
    unsigned channels = 0;
    unsigned threads = 0;
    bool quiet = false;
    DecodeOptions decode; // of a .tess
};

inline void add_fill_options(CLI::App& app, DecodeOptions& decode) {
    app.add_flag("--allow-partial", decode.allow_partial,
                 "Take the beginning of a .tess, as a broken download leaves it; coarser levels "
                 "stand in for what is missing (encode --layers puts them first)");
    app.add_flag("--allow-damaged", decode.allow_damaged,
                 "Let coarser levels, or the background, stand in for damaged tiles of a .tess");
}

inline void add_threads_options(CLI::App& app, TextureArguments& a) {
    app.add_option("--threads", a.threads, "Threads; 0: all cores. Never changes the result")
        ->check(CLI::Range(0u, 1024u))
        ->capture_default_str();
    app.add_flag("--quiet,-q", a.quiet, "No progress and no summary, errors only")
        ->each([](const std::string&) { network_limits().quiet = true; });
}

// Of folders, quilts and mosaics; for those who read them, and for decode, which writes them.
inline void add_view_options(CLI::App& app, TextureArguments& a) {
    const auto add = [&](const char* name, std::string& value, const char* help) {
        app.add_option(name, value, help)->group("Pictures of views");
    };
    add("--views-pattern", a.pattern,
        "Names of a folder's views: {t} is the row, {s} the column, {n} a running number ({n:3}: "
        "three digits), * anything: 'cam_{t:2}_{s:2}_*.png'");
    add("--order", a.order,
        "How numbers and quilts run through the cameras: words of rows, columns, serpentine, "
        "bottom-up, right-left, joined by commas (usual: row by row from the top left, quilts "
        "from the bottom left)");
    add("--quilt", a.quilt,
        "CxR: a picture with the views side by side in C columns and R rows, cameras in a row");
}

inline void add_texture_options(CLI::App& app, TextureArguments& a) {
    app.add_option("--size", a.size, "UxVxSxT of a raw input, or of a mosaic that does not say it");
    app.add_option("--type", a.type, "Sample type of the input: unorm8 or half");
    app.add_option("--channels", a.channels, "Channels of a .raw input")->check(CLI::Range(1u, 4u));
    add_view_options(app, a);
    app.add_option("--grid", a.grid, "CxR cameras that running numbers, or a quilt's views, fill")
        ->group("Pictures of views");
    app.add_option("--mosaic", a.mosaic,
                   "SxT: a picture of angular images, as a lenslet camera has it")
        ->group("Pictures of views");
    add_threads_options(app, a);
}

inline Result<ViewHints> make_view_hints(const TextureArguments& a) {
    ViewHints hints;
    hints.pattern = a.pattern;
    for (const auto& [option, text, grid] :
         {std::tuple("--grid", &a.grid, &hints.grid), std::tuple("--quilt", &a.quilt, &hints.quilt),
          std::tuple("--mosaic", &a.mosaic, &hints.mosaic)})
        if (!text->empty()) {
            TESSERA_TRY_ASSIGN(*grid, parse_view_grid(*text).with_context(option));
        }
    if (hints.quilt && hints.mosaic)
        return Status(ErrorCode::bad_argument, "--quilt and --mosaic: a picture is one of them");
    if (!a.order.empty()) {
        TESSERA_TRY_ASSIGN(hints.order, parse_view_order(a.order).with_context("--order"));
    }
    return hints;
}

inline Result<TextureHints> make_hints(const TextureArguments& a) {
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
