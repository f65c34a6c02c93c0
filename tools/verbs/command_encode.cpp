#include "format/output_file.h"
#include "format/surface_mesh.h"
#include "tools/support/camera_grid.h"
#include "tools/support/description_text.h"
#include "tools/support/encode_arguments.h"
#include "tools/support/encode_report.h"
#include "tools/support/interrupt.h"
#include "tools/support/memory_budget.h"
#include "tools/support/option_checks.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/source_facts.h"
#include "tools/support/standard_streams.h"
#include "tools/support/texture_arguments.h"
#include "tools/texture_io/mask_io.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"

#include <algorithm>
#include <filesystem>
#include <optional>

namespace tessera {
namespace {

constexpr std::uint64_t longest_mesh_stream = 1u << 28;               // bytes, by FORMAT.md
constexpr std::uint64_t largest_mesh_memory = std::uint64_t{1} << 34; // bytes, once it is decoded

struct EncodeCommand {
    std::string input, output, mesh, reuse;
    TextureArguments texture;
    MaskArguments mask;
    EncodeArguments encode;
    CameraFacts cameras;
    bool in_place = false;
};

// The name of the input for messages. That of a URL is without its password.
std::string name_of_input(const EncodeCommand& a, const OpenedTexture& input) {
    if (input.decoder != nullptr)
        return input.decoder->container().name();
    return a.input == standard_stream ? "standard input" : a.input;
}

std::vector<std::pair<std::string, std::string>> facts_of(const EncodeCommand& a) {
    auto facts = source_facts(a.input, "input");
    if (!a.reuse.empty())
        for (auto& fact : source_facts(a.reuse, "file to reuse"))
            facts.push_back(std::move(fact));
    if (!a.mask.path.empty())
        for (auto& fact : source_facts(a.mask.path, "mask"))
            facts.push_back(std::move(fact));
    return facts;
}

// If another program writes to the input meanwhile, the texels are a mixture of two textures.
Status check_unchanged(const EncodeCommand& a, const std::string& name,
                       const std::vector<std::pair<std::string, std::string>>& before) {
    const auto now = facts_of(a);
    const auto differs = std::ranges::mismatch(before, now);
    if (differs.in1 == before.end() && differs.in2 == now.end())
        return {};
    const std::string what = differs.in1 != before.end()
                                 ? differs.in1->first + ", which was " + differs.in1->second
                                 : differs.in2->first;
    return {ErrorCode::io, name + ": changed while it was being read (" + what + "); run again"};
}

// The file of --reuse; nothing without that option.
Result<std::optional<Decoder>> open_reused(const EncodeCommand& a, const DecodeOptions& opening) {
    if (a.reuse.empty())
        return std::optional<Decoder>();
    TESSERA_TRY(check_reuse_options(a.encode));
    TESSERA_TRY_ASSIGN(auto bytes, open_tess_bytes(a.reuse, "encode --reuse"));
    auto decoder = Decoder::open(std::move(bytes), opening);
    if (!decoder.ok())
        return with_memory_hint(decoder.status());
    return std::optional(std::move(*decoder));
}

// The effort that a file states in its metadata, else the default.
int effort_of(const ContainerReader& file) {
    const auto recorded = file.metadata().find(made_effort_key);
    std::uint64_t effort = 0;
    const bool is_known = recorded != file.metadata().end() &&
                          parse_number(recorded->second, effort) && effort <= most_effort;
    return is_known ? static_cast<int>(effort) : usual_effort;
}

// An edited texture keeps the description and metadata of the file that it was decoded from, unless
// the input states its own; a raw one does not.
void describe_as(const ContainerReader& reused, OpenedTexture& input) {
    if (input.description == Description())
        input.description = reused.description();
    for (const auto& entry : reused.metadata())
        input.metadata.insert(entry);
}

// Many views of a grid of cameras are planar views, unless the command line states another surface.
Status describe_cameras(const EncodeCommand& a, OpenedTexture& input) {
    const bool other = a.encode.description.contains("proxy") || !a.mesh.empty() ||
                       a.encode.description.contains("angular-map") ||
                       a.encode.description.contains("surface-map");
    if (other || !input.planar) {
        if (a.cameras.empty())
            return {};
        if (other || input.description.angular_map != AngularMap::planar_views)
            return {ErrorCode::bad_argument,
                    "--camera-spacing, --camera-fov and --camera-focus belong to views of a planar "
                    "grid of cameras"};
    }
    input.description.angular_map = AngularMap::planar_views;
    if (!a.cameras.empty() || !input.metadata.contains(cameras_key)) {
        TESSERA_TRY_ASSIGN(const auto cameras, camera_grid(a.cameras, input.source->desc().size));
        input.metadata[cameras_key] = to_string(cameras);
    }
    return {};
}

Result<OpenedTexture> open_input(const EncodeCommand& a, TextureHints hints,
                                 const ContainerReader* reused) {
    if (reused != nullptr && !hints.size && kind_of_input(a.input) == TextureKind::raw)
        hints.size = reused->desc().size;
    auto input = open_texture(a.input, hints);
    if (!input.ok())
        return with_memory_hint(input.status());
    if (reused != nullptr)
        describe_as(*reused, *input);
    input->metadata.erase(software_key); // the encoder writes its own name
    TESSERA_TRY(describe_cameras(a, *input));
    return input;
}

// The mesh of --mesh, else that of the input or of the file of --reuse. Empty if there is none.
Result<std::vector<std::byte>> mesh_for(const EncodeCommand& a, const ContainerReader* reused,
                                        const OpenedTexture& input) {
    if (a.mesh.empty()) {
        const auto* file = input.decoder != nullptr ? &input.decoder->container() : reused;
        const auto kept = file != nullptr ? file->proxy_mesh() : std::span<const std::byte>();
        return std::vector<std::byte>(kept.begin(), kept.end());
    }
    TESSERA_TRY_ASSIGN(const auto file, open_file(a.mesh));
    if (file->size() > longest_mesh_stream)
        return Status(ErrorCode::unsupported, a.mesh + ": more than 2^28 bytes");
    std::vector<std::byte> mesh(file->size());
    TESSERA_TRY(file->read(0, mesh));
    TESSERA_TRY(decode_mesh(mesh, largest_mesh_memory).with_context(a.mesh));
    return mesh;
}

Result<EncodeOptions> options_for(const EncodeCommand& a, const Decoder* reused,
                                  OpenedTexture& input) {
    const ContainerReader* const old = reused != nullptr ? &reused->container() : nullptr;
    TESSERA_TRY_ASSIGN(std::vector<std::byte> mesh, mesh_for(a, old, input));
    if (!mesh.empty())
        input.description.proxy = Proxy::mesh;
    TESSERA_TRY_ASSIGN(auto options,
                       make_encode_options(a.encode, a.texture.threads, std::move(input.metadata),
                                           input.description));
    if (options.description.proxy == Proxy::mesh) { // --proxy may state another one
        if (mesh.empty())
            return Status(ErrorCode::bad_argument,
                          "--proxy mesh: needs --mesh, or a .tess input with a mesh");
        options.mesh = std::move(mesh);
    }
    if (reused != nullptr) {
        options.reuse = reused;
        options.layers = options.layers || old->levels().size() > 1;
        options.effort = a.encode.effort.value_or(effort_of(*old));
    }
    TESSERA_TRY(check_for(a.encode, options, input.source->desc()));
    options.labels.source = name_of_input(a, input);
    options.labels.facts = facts_of(a);
    options.confirm = [&a, labels = options.labels] {
        return check_unchanged(a, labels.source, labels.facts);
    };
    return options;
}

// Prints how pictures were interpreted, before the work begins.
void print_interpretation(const EncodeCommand& a, const OpenedTexture& input) {
    if (a.texture.quiet || a.encode.json || input.told.empty())
        return;
    const TextureDesc& desc = input.source->desc();
    std::FILE* to = summary_stream(a.output);
    std::fprintf(to, "%s: %s; %s, %d x %s\n", printable(a.input).c_str(),
                 printable(input.told).c_str(), to_string(desc.size).c_str(), desc.channels,
                 name_of(desc.type));
    std::fflush(to);
}

void print_result(const EncodeCommand& a, const OpenedTexture& input, const EncodeOptions& options,
                  const EncodeReport& report, const Warnings& warnings) {
    const TextureDesc& desc = input.source->desc();
    if (a.encode.json) {
        Json json = report_json(a.output, desc, options, report);
        json["input"] = a.input;
        if (!input.told.empty())
            json["understood_as"] = input.told;
        json["warnings"] = warnings.json();
        print_json(json);
    } else if (!a.texture.quiet) {
        print_report(summary_stream(a.output), a.output, desc, report);
    }
    warnings.print("encode");
}

// Compressing a file once more over itself loses quality, and is seldom meant.
Status check_not_input(const EncodeCommand& a) {
    std::error_code ignored;
    if (a.in_place || !std::filesystem::equivalent(to_path(a.input), to_path(a.output), ignored))
        return {};
    return {ErrorCode::bad_argument,
            a.output + ": is the input; write to another name, or say --in-place to replace it"};
}

Status run(const EncodeCommand& a) {
    // Errors of the command line alone come first, before a file is opened.
    if (kind_of(a.output) != TextureKind::tess && a.output != standard_stream)
        return {ErrorCode::bad_argument, a.output + ": encode writes .tess files"};
    TESSERA_TRY(check_tess_output(a.encode, a.output));
    TESSERA_TRY(check_not_input(a));
    Warnings warnings(a.encode.strict);
    TESSERA_TRY_ASSIGN(auto hints, make_hints(a.texture));
    hints.warnings = &warnings;
    TESSERA_TRY_ASSIGN(const auto checked,
                       make_encode_options(a.encode, a.texture.threads, {}, {}));
    hints.decode = within_budget(hints.decode, checked.slab_bytes, a.reuse.empty() ? 1 : 2);
    TESSERA_TRY_ASSIGN(const std::optional<Decoder> reused, open_reused(a, hints.decode));
    TESSERA_TRY_ASSIGN(OpenedTexture input,
                       open_input(a, hints, reused ? &reused->container() : nullptr));
    TESSERA_TRY_ASSIGN(auto options, options_for(a, reused ? &*reused : nullptr, input));
    input.source = interruptible(std::move(input.source));
    const auto mask =
        open_mask(a.mask, input.source->desc().size, a.texture.threads, options.slab_bytes);
    if (!mask.ok())
        return with_memory_hint(mask.status());
    options.mask = mask->get();
    print_interpretation(a, input);
    const auto report = [&] {
        Progress progress("tessera encode", a.texture.quiet);
        options.progress = progress.function();
        return encode_to(*input.source, a.output, options);
    }();
    if (!report.ok())
        return with_memory_hint(report.status());
    count_replaced(*report, warnings);
    print_result(a, input, options, *report, warnings);
    return check_target(a.output, options, *report);
}

void declare_cameras(CLI::App& c, CameraFacts& cameras) {
    OptionGroup group(c, views_heading);
    group.option("--camera-spacing", "X[,Y]", cameras.spacing,
                 "Distance of neighbouring cameras of a planar grid, in world units");
    group.option("--camera-fov", "DEGREES", cameras.fov, "Horizontal field of view. Default: 40");
    group.option("--camera-focus", "LENGTH", cameras.focus,
                 "Where the views coincide. Default: 4 times the grid's longer side");
}

void declare(CLI::App& c, EncodeCommand& a) {
    add_rate_options(c, a.encode); // the first heading
    c.add_option("input", a.input,
                 "A folder of views (PNG, JPEG, EXR, TIFF and others), a quilt or mosaic as one "
                 "picture, a film of views (.y4m), raw samples (.rgb ...), a .tess or its URL, - "
                 "for standard input")
        ->required();
    c.add_option("-o,--output", a.output, "The .tess file to write; - is standard output")
        ->required();
    add_run_options(c, a.encode);
    c.add_flag("--in-place", a.in_place,
               "The output may be the input, which is replaced once the new file is complete");
    add_texture_options(c, a.texture);
    declare_cameras(c, a.cameras);
    add_layout_options(c, a.encode);
    OptionGroup(c, layout_heading)
        .option("--reuse", "FILE", a.reuse,
                "The .tess that the input was decoded from and edited: unmodified tiles are "
                "copied. Gives size, quantiser, tile shape, effort and description");
    add_mask_options(c, a.mask,
                     "masked texels take the values that cost least, and rate targets ignore them");
    c.get_option("--mask")->option_text("FILE")->group(layout_heading);
    c.get_option("--mask-size")->option_text("UxVxSxT")->group(layout_heading);
    add_description_options(c, a.encode);
    c.get_option("--proxy")->description(description_field_values("proxy") + ", mesh");
    OptionGroup(c, description_heading)
        .option("--mesh", "FILE", a.mesh,
                "The surface, a Draco mesh with uv. A .tess input keeps its own");
    add_network_options(c);
}

} // namespace

void add_encode_command(CLI::App& app, Invocation& chosen) {
    add_verb<EncodeCommand>(
        app, chosen, "encode", "Compress a texture into a .tess file",
        "The same texels and options give the same bytes, with any number of threads. Finished "
        "tiles are kept in OUTPUT.journal until the file is complete; --resume needs the same "
        "options.\n\n"
        "Examples:\n"
        "  tessera encode scene.exr -o scene.tess --target-psnr 40\n"
        "  tessera encode scene.rgb --size 512x256x32x32 -o scene.tess --lossless\n"
        "  tessera encode views/ -o views.tess --max-error 2 --effort 4\n"
        "  tessera encode rig/ -o rig.tess --grid 17x17 --order serpentine,bottom-up\n"
        "  tessera encode photo_qs8x6a0.75.png -o quilt.tess --camera-spacing 0.02\n"
        "  cat a.rgb | tessera encode - --size 64x64x8x8 --type unorm8 --channels 3 -o - > a.tess\n"
        "  tessera encode edited.rgb --reuse old.tess -o new.tess",
        declare, run);
}

} // namespace tessera
