#include "format/surface_mesh.h"
#include "tools/support/camera_grid.h"
#include "tools/support/encode_arguments.h"
#include "tools/support/encode_report.h"
#include "tools/support/interrupt.h"
#include "tools/support/memory_budget.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/source_facts.h"
#include "tools/support/standard_streams.h"
#include "tools/support/texture_arguments.h"
#include "tools/texture_io/mask_io.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"

#include <algorithm>
#include <optional>

namespace tessera {
namespace {

constexpr std::uint64_t longest_mesh_stream = 1u << 28;               // a file's head holds no more
constexpr std::uint64_t largest_mesh_memory = std::uint64_t{1} << 34; // of the largest there is

struct EncodeCommand {
    std::string input, output, mesh, reuse;
    TextureArguments texture;
    MaskArguments mask;
    EncodeArguments encode;
    CameraFacts cameras;
};

// The encoder does not know what its texels came from. A URL is named without its password.
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

// A file that another program writes meanwhile gives texels of two textures.
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

// The file of --reuse; nothing without one.
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

// The effort that a file was encoded at, if it says so.
int effort_of(const ContainerReader& file) {
    const auto recorded = file.metadata().find(made_effort_key);
    std::uint64_t effort = 0;
    const bool is_known = recorded != file.metadata().end() &&
                          parse_number(recorded->second, effort) && effort <= most_effort;
    return is_known ? static_cast<int>(effort) : usual_effort;
}

// What was decoded from a file and edited is still what that file says of it, where it does not say
// otherwise itself: a raw one says nothing.
void describe_as(const ContainerReader& reused, OpenedTexture& input) {
    if (input.description == Description())
        input.description = reused.description();
    for (const auto& entry : reused.metadata())
        input.metadata.insert(entry);
}

// The mesh that is asked for, else that of a .tess, which then is the proxy.
Result<std::vector<std::byte>> mesh_for(const EncodeCommand& a, const ContainerReader* reused,
                                        OpenedTexture& input) {
    std::vector<std::byte> mesh;
    if (!a.mesh.empty()) {
        TESSERA_TRY_ASSIGN(const auto file, open_file(a.mesh));
        if (file->size() > longest_mesh_stream)
            return Status(ErrorCode::unsupported, a.mesh + ": more than 2^28 bytes");
        mesh.resize(file->size());
        TESSERA_TRY(file->read(0, mesh));
        TESSERA_TRY(decode_mesh(mesh, largest_mesh_memory).with_context(a.mesh));
    } else if (const auto* described =
                   input.decoder != nullptr ? &input.decoder->container() : reused) {
        const auto kept = described->proxy_mesh();
        mesh.assign(kept.begin(), kept.end());
    }
    if (!mesh.empty())
        input.description.proxy = Proxy::mesh;
    return mesh;
}

// Many views of a grid of cameras are planar views, unless the command line says what else they are.
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

// What pictures were taken for, before the work begins.
void tell(const EncodeCommand& a, const std::string& told, const TextureDesc& desc) {
    if (a.texture.quiet || a.encode.json || told.empty())
        return;
    std::FILE* to = summary_stream(a.output);
    std::fprintf(to, "%s: %s; %s, %d x %s\n", printable(a.input).c_str(), printable(told).c_str(),
                 to_string(desc.size).c_str(), desc.channels, name_of(desc.type));
    std::fflush(to);
}

Status run(const EncodeCommand& a) {
    // What the command line alone shows to be wrong, before a file is opened.
    if (kind_of(a.output) != TextureKind::tess && a.output != standard_stream)
        return {ErrorCode::bad_argument, a.output + ": encode writes .tess files"};
    TESSERA_TRY(check_tess_output(a.encode, a.output));
    TESSERA_TRY_ASSIGN(auto hints, make_hints(a.texture));
    TESSERA_TRY_ASSIGN(const auto checked,
                       make_encode_options(a.encode, a.texture.threads, {}, {}));
    hints.decode = within_budget(hints.decode, checked.slab_bytes, a.reuse.empty() ? 1 : 2);
    TESSERA_TRY_ASSIGN(const std::optional<Decoder> reused, open_reused(a, hints.decode));
    const ContainerReader* const old = reused ? &reused->container() : nullptr;
    if (old != nullptr && !hints.size && kind_of_input(a.input) == TextureKind::raw)
        hints.size = old->desc().size;
    auto opened = open_texture(a.input, hints);
    if (!opened.ok())
        return with_memory_hint(opened.status());
    OpenedTexture& input = *opened;
    if (old != nullptr)
        describe_as(*old, input);
    input.metadata.erase(software_key); // the encoder names itself
    TESSERA_TRY(describe_cameras(a, input));
    TESSERA_TRY_ASSIGN(std::vector<std::byte> mesh, mesh_for(a, old, input));
    TESSERA_TRY_ASSIGN(auto options,
                       make_encode_options(a.encode, a.texture.threads, std::move(input.metadata),
                                           input.description));
    if (options.description.proxy == Proxy::mesh) // --proxy may have put another in its place
        options.mesh = std::move(mesh);
    if (old != nullptr) {
        options.reuse = &*reused;
        options.layers = options.layers || old->levels().size() > 1;
        options.effort = a.encode.effort.value_or(effort_of(*old));
    }
    const auto source = interruptible(std::move(input.source));
    TESSERA_TRY(check_for(a.encode, options, source->desc()));
    const auto mask = open_mask(a.mask, source->desc().size, a.texture.threads, options.slab_bytes);
    if (!mask.ok())
        return with_memory_hint(mask.status());
    options.mask = mask->get();
    options.source_name = name_of_input(a, input);
    options.source_facts = facts_of(a);
    options.confirm = [&a, name = options.source_name, before = options.source_facts] {
        return check_unchanged(a, name, before);
    };
    tell(a, input.told, source->desc());
    const auto report = [&] {
        Progress progress("tessera encode", a.texture.quiet);
        options.progress = progress.function();
        return encode_to(*source, a.output, options);
    }();
    if (!report.ok())
        return with_memory_hint(report.status());
    if (a.encode.json) {
        Json json = report_json(a.output, source->desc(), options, *report);
        json["input"] = a.input;
        if (!input.told.empty())
            json["understood_as"] = input.told;
        print_json(json);
    } else if (!a.texture.quiet) {
        print_report(summary_stream(a.output), a.output, source->desc(), *report);
    }
    return check_target(a.output, options, *report);
}

} // namespace

void add_encode_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, EncodeCommand& a) {
        c.add_option(
             "input", a.input,
             "Texture: folder of views (PNG, JPEG, EXR), quilt or mosaic as one picture, raw "
             "(.rgb ...), .tess or the URL of one, - for standard input")
            ->required();
        c.add_option("-o,--output", a.output, "The .tess file to write; - is standard output")
            ->required();
        add_texture_options(c, a.texture);
        add_network_options(c);
        add_mask_options(c, a.mask, "the others get what costs least, and no target binds them");
        add_encode_options(c, a.encode);
        c.add_option("--reuse", a.reuse,
                     "A .tess that the input was decoded from and edited since: tiles that are "
                     "still what it decodes to stay, byte for byte, the others get its quantiser, "
                     "shape, tables and, unless said, effort; size and description are its, too");
        c.add_option(
             "--mesh", a.mesh,
             "The surface: a Draco mesh with uv, stored as the proxy (that of a .tess is kept)")
            ->group("Description");
        c.add_option("--camera-spacing", a.cameras.spacing,
                     "Of planar views: from camera to camera, X or X,Y, in world units")
            ->group("Pictures of views");
        c.add_option("--camera-fov", a.cameras.fov, "Degrees that a view is wide (usual: 40)")
            ->group("Pictures of views");
        c.add_option("--camera-focus", a.cameras.focus,
                     "Distance at which the views coincide, in world units; large for cameras "
                     "whose axes are parallel (usual: four times the grid's longer side)")
            ->group("Pictures of views");
    };
    add_verb<EncodeCommand>(
        app, chosen, "encode", "Compress a texture into a .tess file",
        "At most one rate is asked for: --quality, --target-psnr, --target-bpt, --target-bytes or\n"
        "--max-error. Finished tiles wait in OUTPUT.journal until the file is there, for "
        "--resume.\n"
        "The same texels and options give the same bytes, on any number of threads; the file says\n"
        "which rate and effort it was made with (tessera info).\n\n"
        "Examples:\n"
        "  tessera encode scene.exr -o scene.tess --target-psnr 40\n"
        "  tessera encode scene.rgb --size 512x256x32x32 -o scene.tess\n"
        "  cat scene.rgb | tessera encode - --size 64x64x8x8 --type unorm8 --channels 3 -o - > "
        "x.tess\n"
        "  tessera encode views/ -o views.tess --max-error 2 --effort 4\n"
        "  tessera encode rig/ -o rig.tess --grid 17x17 --order serpentine,bottom-up\n"
        "  tessera encode photo_qs8x6a0.75.png -o quilt.tess --camera-spacing 0.02\n"
        "  tessera decode old.tess -o edited.rgb    (edit, then without any loss elsewhere:)\n"
        "  tessera encode edited.rgb --reuse old.tess -o new.tess\n"
        "  tessera encode atlas.exr -o atlas.tess --mask charts.gray --mask-size 512x256x1x1",
        declare, run);
}

} // namespace tessera
