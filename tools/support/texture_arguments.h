// Options that say what a texture is, which the verbs that read one share.
#pragma once

#include "tools/support/network_limits.h"
#include "tools/support/parse.h"
#include "tools/support/texture_hints.h"

#include <CLI/CLI.hpp>
#include <string>

namespace tessera {

inline constexpr const char* views_heading = "Folders of views, quilts and mosaics"; // of the help

struct TextureArguments {
    std::string size, type;
    std::string pattern, grid, quilt, mosaic, order; // of views
    std::string layer, yuv_matrix;
    bool no_exif = false;
    unsigned channels = 0;
    unsigned threads = 0;
    bool quiet = false;
    DecodeOptions decode; // of a .tess
};

// --allow-partial and --allow-damaged.
void add_fill_options(CLI::App& app, DecodeOptions& decode);
// --threads and --quiet.
void add_threads_options(CLI::App& app, TextureArguments& arguments);
// The options of folders, quilts and mosaics that both reading and writing need.
void add_view_options(CLI::App& app, TextureArguments& arguments);
// All options of an input, and add_threads_options().
void add_texture_options(CLI::App& app, TextureArguments& arguments);

// The texts, parsed. Errors: bad_argument, with the option.
Result<ViewHints> make_view_hints(const TextureArguments& arguments);
Result<TextureHints> make_hints(const TextureArguments& arguments);

} // namespace tessera
