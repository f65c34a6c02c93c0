// Options that say what a texture is, shared by the verbs that read one.
#pragma once

#include "tools/support/network_limits.h"
#include "tools/support/parse.h"
#include "tools/support/texture_hints.h"

#include <CLI/CLI.hpp>
#include <string>

namespace tessera {

struct TextureArguments {
    std::string size, type;
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

inline void add_texture_options(CLI::App& app, TextureArguments& a) {
    app.add_option("--size", a.size,
                   "UxVxSxT of a raw input, or of an EXR mosaic that does not say it");
    app.add_option("--type", a.type, "Sample type of the input: unorm8 or half");
    app.add_option("--channels", a.channels, "Channels of a .raw input")->check(CLI::Range(1u, 4u));
    add_threads_options(app, a);
}

inline Result<TextureHints> make_hints(const TextureArguments& a) {
    TextureHints hints;
    hints.threads = a.threads;
    hints.decode = a.decode;
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
