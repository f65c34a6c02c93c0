#include "tools/verbs/glb_output.h"

#include "tools/support/option_checks.h"
#include "tools/support/output_folders.h"
#include "tools/support/progress.h"

namespace tessera {

void add_glb_options(CLI::App& app, GlbArguments& a) {
    OptionGroup group(app, "glTF outputs (.glb)");
    group.option("--mesh-compression", "KIND", a.mesh_compression,
                 "Compress meshes: draco (KHR_draco_mesh_compression), or meshopt "
                 "(EXT_meshopt_compression), which readers decode faster. Default: none",
                 one_of({"none", "draco", "meshopt"}));
    group.option(
        "--jpeg", "1..100", a.jpeg_quality,
        "Store the picture that other viewers show as a JPEG of this quality. Default: PNG",
        CLI::Range(1, 100));
    group.option("--picture-side", "N", a.picture_side,
                 "Most pixels along a side of this picture. Default: 1024", CLI::Range(1u, 16384u));
}

Status check_glb_options(const GlbArguments& a, const std::string& output) {
    for (const auto& [option, given] :
         {std::pair("--mesh-compression", a.mesh_compression.has_value()),
          std::pair("--jpeg", a.jpeg_quality.has_value()),
          std::pair("--picture-side", a.picture_side.has_value())})
        if (given && !is_glb_name(output))
            return {ErrorCode::bad_argument,
                    std::string(option) + ": needs a .glb output, not " + output};
    return {};
}

Result<GlbReport> write_glb_output(std::span<const GlbInput> inputs, const std::string& output,
                                   const GlbArguments& a, const GlbRun& run) {
    Progress progress(run.verb, run.quiet);
    GlbOptions options{.mesh = parse_value<MeshCompression>(a.mesh_compression.value_or("none"))
                                   .value_or(MeshCompression::none),
                       .jpeg_quality = a.jpeg_quality,
                       .threads = run.threads,
                       .progress = progress.function()};
    options.picture_side = a.picture_side.value_or(options.picture_side);
    return write_glb(inputs, output, options);
}

} // namespace tessera
