// The options of .glb outputs, which `bake` and `convert` share.
#pragma once

#include "tools/gltf/glb_writer.h"

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace tessera {

struct GlbArguments {
    std::optional<std::string> mesh_compression; // a name of MeshCompression
    std::optional<int> jpeg_quality;
    std::optional<std::uint32_t> picture_side; // pixels
};

void add_glb_options(CLI::App& app, GlbArguments& arguments);

// Refuses the options if `output` is not a .glb. Errors: bad_argument.
Status check_glb_options(const GlbArguments& arguments, const std::string& output);

// The options of write_glb(). `verb` names the command in front of the progress.
struct GlbRun {
    const char* verb = "tessera convert";
    unsigned threads = 0;
    bool quiet = false;
};

// write_glb() with these arguments, and with progress on a terminal. Errors: those of write_glb().
Result<GlbReport> write_glb_output(std::span<const GlbInput> inputs, const std::string& output,
                                   const GlbArguments& arguments, const GlbRun& run);

} // namespace tessera
