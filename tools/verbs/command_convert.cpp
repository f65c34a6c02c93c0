#include "format/container_reader.h"
#include "format/output_file.h"
#include "tools/support/copy_bytes.h"
#include "tools/support/json_text.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/standard_streams.h"
#include "tools/support/texture_arguments.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"
#include "tools/verbs/glb_output.h"

#include <cstdio>

namespace tessera {
namespace {

struct ConvertCommand {
    std::vector<std::string> inputs;
    std::string output;
    GlbArguments glb;
    TextureArguments texture; // threads and quiet
    bool json = false;
};

// Writes the bytes of the .tess file as they are.
Status extract_tess(const ConvertCommand& a) {
    TESSERA_TRY_ASSIGN(const auto from, open_tess_bytes(a.inputs.front(), "convert"));
    TESSERA_TRY(ContainerReader::open(*from).status()); // refuses what is not a complete file
    TESSERA_TRY(make_parent_folders(a.output));
    TESSERA_TRY_ASSIGN(OutputFile file, OutputFile::create(a.output));
    TESSERA_TRY(copy_bytes(*from, file));
    TESSERA_TRY(file.commit());
    if (a.json)
        print_json({{"output", a.output}, {"bytes", from->size()}});
    else if (!a.texture.quiet)
        std::printf("%s: %s\n", a.output.c_str(), human_bytes(from->size()).c_str());
    return {};
}

Status make_glb(const ConvertCommand& a) {
    std::vector<GlbInput> inputs;
    for (const std::string& name : a.inputs)
        inputs.push_back({.name = name});
    TESSERA_TRY_ASSIGN(
        const GlbReport report,
        write_glb_output(inputs, a.output, a.glb,
                         {.threads = a.texture.threads, .quiet = a.texture.quiet || a.json}));
    if (a.json) {
        Json json = {{"output", a.output}};
        json.update(to_json(report));
        print_json(json);
    } else if (!a.texture.quiet) {
        std::printf("%s: %s\n", a.output.c_str(), to_string(report).c_str());
    }
    return {};
}

Status run(const ConvertCommand& a) {
    TESSERA_TRY(check_glb_options(a.glb, a.output));
    const bool to_glb = is_glb_name(a.output);
    if (!to_glb && kind_of(a.output) != TextureKind::tess)
        return {ErrorCode::bad_argument,
                a.output + ": convert writes .glb and .tess; decode writes other kinds"};
    if (!to_glb && a.inputs.size() > 1)
        return {ErrorCode::bad_argument,
                a.output + ": a .tess has one input; several become a .glb"};
    TESSERA_TRY(check_output_path(a.output));
    return to_glb ? make_glb(a) : extract_tess(a);
}

} // namespace

void add_convert_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, ConvertCommand& a) {
        c.add_option("input", a.inputs,
                     "A .tess, or a .glb that holds one; also its URL (http, https). Several "
                     "become one .glb, each with a node of its own")
            ->required();
        c.add_option("-o,--output", a.output, ".glb, or .tess to get back the file in a .glb")
            ->required();
        c.add_flag("--json", a.json, "Print JSON");
        add_threads_options(c, a.texture);
        add_glb_options(c, a.glb);
    };
    add_verb<ConvertCommand>(
        app, chosen, "convert", "Turn a .tess into a glTF file, and back",
        "A .glb holds the mesh, a picture of its texture, and the .tess. Every viewer of glTF "
        "shows the picture, without gloss: the mean over all directions. With a plugin, three.js "
        "and "
        "Babylon.js show the texture itself. All verbs that read a .tess read such a .glb.\n\n"
        "Examples:\n"
        "  tessera convert bunny.tess -o bunny.glb\n"
        "  tessera convert bunny.tess -o small.glb --mesh-compression draco --jpeg 85\n"
        "  tessera convert bunny.tess floor.tess -o scene.glb\n"
        "  tessera convert bunny.glb -o bunny.tess\n"
        "  tessera convert scene.glb#1 -o floor.tess",
        declare, run);
}

} // namespace tessera
