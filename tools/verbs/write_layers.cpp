#include "tools/verbs/write_layers.h"

#include "tools/support/encode_report.h"
#include "tools/support/interrupt.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/standard_streams.h"
#include "tools/verbs/encode_layers.h"

#include <cstdio>

namespace tessera {
namespace {

void report_layers(const BakeCommand& a, const BakedLayers& baked, const CodedLayers& coded,
                   const std::optional<GlbReport>& glb, const Warnings& warnings) {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - baked.start;
    const corpus::ModelLayers& layers = baked.layers;
    if (a.encode.json) {
        Json json = {{"output", a.output},
                     {"bytes", coded.file.size()},
                     {"quality", *coded.quality},
                     {"seconds", seconds.count()},
                     {"triangles", layers.decoded_mesh.triangles.size()},
                     {"charts", layers.charts},
                     {"mesh_bytes", layers.mesh.size()},
                     {"texels_per_unit", baked.density},
                     {"lights", layers.lights.size()},
                     {"warnings", warnings.json()},
                     {"layers", layers_json(coded)}};
        json.update(baked.json);
        if (glb)
            json["glb"] = to_json(*glb);
        print_json(json);
        return;
    }
    warnings.print("bake");
    if (a.texture.quiet)
        return;
    std::FILE* const to = summary_stream(a.output);
    std::fprintf(to, "%s: %s in %.1f s, %s\n", a.output.c_str(),
                 human_bytes(coded.file.size()).c_str(), seconds.count(), rate_text(coded).c_str());
    print_layers(to, layers, coded);
    std::fprintf(to, "  %s\n", baked.remark.c_str());
    if (glb)
        std::fprintf(to, "  glTF file of %s\n", to_string(*glb).c_str());
}

Status write_layered_file(const std::string& path, std::span<const std::byte> bytes) {
    if (path == standard_stream) {
        TESSERA_TRY(write_standard_output(bytes));
        return flush_standard_output();
    }
    TESSERA_TRY(make_parent_folders(path));
    return write_bytes(path, bytes);
}

} // namespace

corpus::BakeRun bake_run(const BakeCommand& a, ProgressFunction progress) {
    return {.threads = a.texture.threads, .progress = std::move(progress), .cancelled = [] {
                return interrupted_by() != 0;
            }};
}

Status write_layers(const BakeCommand& a, const BakedLayers& baked, const Warnings& warnings) {
    CodedLayers coded;
    {
        Progress progress("tessera bake", a.texture.quiet || a.encode.json);
        EncodeArguments arguments = a.encode;
        arguments.description.erase("proxy"); // that of the first layer alone
        TESSERA_TRY_ASSIGN(EncodeOptions encode, make_encode_options(arguments, a.texture.threads,
                                                                     metadata_of(baked.facts), {}));
        encode.mesh = baked.layers.mesh;
        const corpus::BakeRun run = bake_run(a, progress.function());
        encode.progress = run.progress;
        encode.cancelled = run.cancelled;
        TESSERA_TRY_ASSIGN(
            coded,
            encode_layers(baked.layers, encode, rate_of_layers(a.encode)).with_context(a.output));
    }
    std::optional<GlbReport> glb;
    if (is_glb_name(a.output)) {
        TESSERA_TRY_ASSIGN(glb, write_baked_glb(a, coded.file));
    } else {
        TESSERA_TRY(write_layered_file(a.output, coded.file));
    }
    report_layers(a, baked, coded, glb, warnings);
    return {};
}

} // namespace tessera
