#include "corpus/bake.h"
#include "tools/support/copy_texture.h"
#include "tools/support/encode_arguments.h"
#include "tools/support/encode_report.h"
#include "tools/support/interrupt.h"
#include "tools/support/memory_budget.h"
#include "tools/support/output_folders.h"
#include "tools/support/progress.h"
#include "tools/support/standard_streams.h"
#include "tools/support/texture_arguments.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"

#include <chrono>
#include <cstdio>

namespace tessera {
namespace {

struct BakeCommand {
    std::string scene, output;
    TextureArguments texture; // threads and quiet; size is the size to bake
    unsigned samples = 16;
    std::uint64_t seed = 1;
    bool list = false;
    EncodeArguments encode;
};

bool is_compressed(const BakeCommand& a) {
    return a.output == standard_stream || kind_of(a.output) == TextureKind::tess;
}

Status list_scenes() {
    for (const corpus::SceneInfo& scene : corpus::scenes())
        std::printf("%-14s %-16s %-7s %s\n", scene.name.c_str(),
                    to_string(scene.default_size).c_str(), name_of(scene.type),
                    scene.description.c_str());
    return {};
}

// Every scene lies inside the paper's sphere of diameter 7.
Description baked_description(SampleType type) {
    Description d;
    d.proxy = Proxy::sphere;
    d.sphere_radius = 3.5f;
    d.surface_map = SurfaceMap::sphere_longitude_latitude;
    d.angular_map = AngularMap::hemisphere_alpha_beta;
    d.transfer = type == SampleType::unorm8 ? Transfer::srgb : Transfer::linear;
    d.primaries = Primaries::bt709;
    return d;
}

// What the command asks of the encoder; errors that need no texel.
Result<EncodeOptions> options_for(const BakeCommand& a, const TextureDesc& desc) {
    const bool compressed = is_compressed(a);
    if (!compressed && says_how_to_encode(a.encode))
        return Status(ErrorCode::bad_argument,
                      a.output +
                          ": rate, tile, tools, metadata and --resume options need a .tess output");
    Metadata metadata = {{"Scene", a.scene},
                         {"Samples per texel", std::to_string(a.samples)},
                         {"Seed", std::to_string(a.seed)}};
    TESSERA_TRY_ASSIGN(auto options,
                       make_encode_options(a.encode, a.texture.threads, std::move(metadata),
                                           baked_description(desc.type)));
    TESSERA_TRY(check_for(a.encode, options, desc));
    TESSERA_TRY(compressed ? check_tess_output(a.encode, a.output)
                           : check_texture_output(a.output, desc));
    options.source_facts = {{"scene", a.scene},
                            {"samples per texel", std::to_string(a.samples)},
                            {"seed", std::to_string(a.seed)}};
    return options;
}

Json scene_json(const BakeCommand& a) {
    return {{"scene", a.scene}, {"samples_per_texel", a.samples}, {"seed", a.seed}};
}

Status bake_compressed(const BakeCommand& a, TexelSource& source, EncodeOptions options) {
    TESSERA_TRY_ASSIGN(const auto report, [&] {
        Progress progress("tessera bake", a.texture.quiet);
        options.progress = progress.function();
        return encode_to(source, a.output, options);
    }());
    if (a.encode.json) {
        Json json = report_json(a.output, source.desc(), options, report);
        json.update(scene_json(a));
        print_json(json);
    } else if (!a.texture.quiet) {
        print_report(summary_stream(a.output), a.output, source.desc(), report);
    }
    return {};
}

Status bake_plain(const BakeCommand& a, TexelSource& source, const EncodeOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    const TextureDesc& desc = source.desc();
    TESSERA_TRY_ASSIGN(auto sink,
                       create_texture(a.output, desc, options.description, a.texture.threads));
    {
        Progress progress("tessera bake", a.texture.quiet);
        TESSERA_TRY(copy_texture(source, *interruptible(std::move(sink)), a.texture.threads,
                                 progress.function(), "baking", options.slab_bytes));
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const std::uint64_t bytes = desc.box_bytes(Box4::whole(desc.size));
    if (a.encode.json) {
        Json json = {{"output", a.output},         {"size", to_string(desc.size)},
                     {"type", name_of(desc.type)}, {"channels", desc.channels},
                     {"raw_bytes", bytes},         {"seconds", seconds.count()}};
        json.update(scene_json(a));
        print_json(json);
    } else if (!a.texture.quiet) {
        std::printf("%s: %s, %d x %s, %s of texels in %.2f s\n", a.output.c_str(),
                    to_string(desc.size).c_str(), desc.channels, name_of(desc.type),
                    human_bytes(bytes).c_str(), seconds.count());
    }
    return {};
}

Status run(const BakeCommand& a) {
    if (a.list)
        return list_scenes();
    if (a.scene.empty() || a.output.empty())
        return {ErrorCode::bad_argument,
                "a scene and -o OUTPUT are needed; --list shows the scenes"};
    TESSERA_TRY_ASSIGN(const auto scene, corpus::find_scene(a.scene));
    TESSERA_TRY_ASSIGN(const auto size,
                       parse_extent_or(a.texture.size, "--size", scene.default_size));
    TESSERA_TRY_ASSIGN(auto baked, corpus::make_baked_source(a.scene, size, a.samples, a.seed));
    const auto source = interruptible(std::move(baked)); // bakes where it is read
    TESSERA_TRY_ASSIGN(const auto options, options_for(a, source->desc()));
    return with_memory_hint(is_compressed(a) ? bake_compressed(a, *source, options)
                                             : bake_plain(a, *source, options));
}

} // namespace

void add_bake_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, BakeCommand& a) {
        c.add_option("scene", a.scene, "Name of a built-in scene");
        c.add_option(
            "-o,--output", a.output,
            "What to write: .tess (compressed on the way; - is standard output), .exr, .rgb, "
            "folder/");
        c.add_flag("--list", a.list, "Show the scenes and stop");
        c.add_option("--size", a.texture.size, "UxVxSxT (default: the scene's own, see --list)");
        c.add_option("--spp", a.samples, "Rays per texel, over all four dimensions")
            ->check(CLI::Range(1u, corpus::max_samples_per_texel))
            ->capture_default_str();
        c.add_option("--seed", a.seed, "Of the sample pattern")->capture_default_str();
        add_threads_options(c, a.texture);
        add_encode_options(c, a.encode);
    };
    add_verb<BakeCommand>(
        app, chosen, "bake", "Ray trace a built-in scene into a texture",
        "A .tess is compressed while it is baked, so no size is too large for memory; its options\n"
        "are those of encode. Other kinds take --size, --spp, --seed, --threads, --memory only.\n\n"
        "Examples:\n"
        "  tessera bake composed -o composed.tess --size 512x256x32x32 --spp 16\n"
        "  tessera bake composed -o composed.tess --resume    (after an interruption)\n"
        "  tessera bake lamps -o lamps.exr --size 64x32x8x8\n"
        "  tessera bake --list",
        declare, run);
}

} // namespace tessera
