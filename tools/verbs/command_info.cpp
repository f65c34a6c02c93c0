#include "format/container_reader.h"
#include "format/surface_mesh.h"
#include "tools/http/open_bytes.h"
#include "tools/support/description_text.h"
#include "tools/support/fill_text.h"
#include "tools/support/json_text.h"
#include "tools/support/parse.h"
#include "tools/support/texture_arguments.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"
#include "tools/view/layer_files.h"
#include "tools/view/model_cameras.h"

#include <algorithm>
#include <glm/common.hpp>

namespace tessera {
namespace {

constexpr std::uint64_t most_mesh_memory = std::uint64_t{1} << 30;

struct InfoCommand {
    std::string input;
    TextureArguments texture;
    bool json = false;
};

Json texture_json(const std::string& path, const TextureDesc& desc,
                  const Description& description) {
    return {{"file", path},
            {"size", to_string(desc.size)},
            {"type", name_of(desc.type)},
            {"channels", desc.channels},
            {"raw_bytes", desc.box_bytes(Box4::whole(desc.size))},
            {"description", description_to_text(description)}};
}

// Has the key "error" if the section holds no mesh, or one that is too large to decode here.
Json mesh_json(std::span<const std::byte> stream) {
    Json json = {{"bytes", stream.size()}};
    const auto mesh = decode_mesh(stream, most_mesh_memory);
    if (!mesh.ok()) {
        json["error"] = mesh.status().message();
        return json;
    }
    const auto [low, high] = bounds_of(*mesh);
    json["triangles"] = mesh->triangles.size();
    json["vertices"] = mesh->positions.size();
    json["low"] = {low.x, low.y, low.z};
    json["high"] = {high.x, high.y, high.z};
    return json;
}

// Adding a key to a Json searches all keys first. A file has distinct keys, and up to 65,536 of
// them, so they are appended without a search.
Json metadata_json(const Metadata& metadata) {
    Json::object_t::Container entries;
    entries.reserve(metadata.size());
    for (const auto& [key, value] : metadata)
        entries.emplace_back(key, value);
    Json::object_t object;
    static_cast<Json::object_t::Container&>(object) = std::move(entries);
    return object;
}

Json tess_json(const std::string& path, const ContainerReader& file, const TileSummary& tiles) {
    const FileFacts facts = file.facts();
    const TextureDesc& desc = file.desc();
    Json json = texture_json(path, desc, file.description());
    json["kind"] = "tess";
    json["version"] =
        std::to_string(facts.version_major) + "." + std::to_string(facts.version_minor);
    json["file_bytes"] = file.file_bytes();
    if (file.is_partial())
        json["received_bytes"] = file.source_bytes();
    json["bits_per_texel"] =
        static_cast<double>(file.file_bytes()) * 8 / static_cast<double>(texel_count(desc.size));
    json["required_features"] = facts.required_features;
    json["optional_features"] = facts.optional_features;
    json["colour"] = facts.colour;
    json["tile_extent"] = to_string(file.grid().tile_extent());
    if (const ViewAlignment alignment = file.alignment(); alignment.any())
        json["alignment"] = {{"u", alignment.u}, {"v", alignment.v}};
    json["tiles"] = {{"count", tiles.tiles},
                     {"empty", tiles.empty},
                     {"bytes", tiles.bytes},
                     {"largest", tiles.largest}};
    json["page_bytes"] = facts.page_bytes;
    if (!file.proxy_mesh().empty()) {
        json["description"]["proxy"] = "mesh";
        json["mesh"] = mesh_json(file.proxy_mesh());
    }
    json["background"] = Json::array();
    for (std::size_t c = 0; c < desc.channels; ++c)
        json["background"].push_back(facts.background[c]);
    json["levels"] = Json::array();
    for (const Level& level : file.levels())
        json["levels"].push_back({{"size", to_string(level.size)},
                                  {"spatial_lod", level.spatial_lod},
                                  {"angular_lod", level.angular_lod},
                                  {"step_shift", level.step_shift},
                                  {"first_tile", level.first_tile},
                                  {"tiles", level.grid.tiles()}});
    json["sections"] = Json::array();
    for (const SectionInfo& s : file.sections())
        json["sections"].push_back({{"type", s.type},
                                    {"offset", s.offset},
                                    {"length", s.length},
                                    {"required", s.required},
                                    {"known", s.known}});
    json["metadata"] = metadata_json(file.metadata());
    return json;
}

// The layers of a file, the first one included.
Json layers_json(const ContainerReader& file, std::span<const OpenLayerFile> further) {
    const auto row = [](LayerRole role, float scale, const ContainerReader& layer,
                        std::uint64_t bytes) {
        return Json{{"role", name_of(role)},
                    {"size", to_string(layer.desc().size)},
                    {"channels", layer.desc().channels},
                    {"scale", scale},
                    {"bytes", bytes}};
    };
    std::uint64_t rest = file.file_bytes();
    Json json = Json::array({nullptr});
    for (const OpenLayerFile& layer : further) {
        const std::uint64_t bytes = layer.info.beginning_bytes + layer.info.data_bytes;
        rest -= bytes;
        json.push_back(row(layer.info.role, layer.info.scale, layer.decoder->container(), bytes));
    }
    json[0] = row(LayerRole::diffuse, file.layers().scale, file, rest);
    return json;
}

// A value in one line. Floating-point numbers are rounded to four significant digits.
std::string text_of(const Json& value) {
    if (value.is_number_float()) {
        char text[32];
        std::snprintf(text, sizeof text, "%.4g", value.get<double>());
        return text;
    }
    return value.is_string() ? value.get<std::string>()
                             : value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// "psnr 40.123456789012345" -> "--target-psnr 40.12": the option of encode, its number rounded.
std::string rate_option(const std::string& rate) {
    const std::size_t blank = rate.find(' ');
    if (blank == std::string::npos)
        return rate;
    const std::string kind = rate.substr(0, blank), number = rate.substr(blank + 1);
    const bool is_target = kind == "psnr" || kind == "bpt" || kind == "bytes";
    std::uint64_t whole = 0;
    double value = 0;
    const bool rounds = !parse_number(number, whole) && parse_number(number, value);
    return (is_target ? "--target-" : "--") + kind + " " + (rounds ? text_of(value) : number);
}

// How the file was encoded: "Tessera 0.1.0, --target-psnr 40 --effort 3"; "" if it does not say.
std::string made_text(const Metadata& metadata) {
    const auto value_of = [&](const char* key) {
        const auto found = metadata.find(key);
        return found == metadata.end() ? std::string() : found->second;
    };
    std::string text = value_of(software_key), options;
    if (const std::string rate = value_of(made_rate_key); !rate.empty())
        options = rate_option(rate);
    if (const std::string effort = value_of(made_effort_key); !effort.empty())
        options += (options.empty() ? "" : " ") + ("--effort " + effort);
    return text + (text.empty() || options.empty() ? "" : ", ") + options;
}

// The JSON of a .tess, changed for people: sizes also in units, and how the file was encoded in one
// line instead of in several keys of the metadata.
Json for_people(Json json, const Metadata& metadata) {
    Json out;
    for (auto& [key, value] : json.items()) {
        if ((key == "raw_bytes" || key == "file_bytes" || key == "received_bytes") &&
            value.get<std::uint64_t>() >= 1000)
            value = std::to_string(value.get<std::uint64_t>()) + " (" +
                    human_bytes(value.get<std::uint64_t>()) + ")";
        if (key == "metadata") {
            if (const std::string made = made_text(metadata); !made.empty())
                out["made"] = made;
            for (const char* shown :
                 {software_key, made_rate_key, made_effort_key, model_cameras_key})
                value.erase(shown);
        }
        out[key] = value;
    }
    return out;
}

// Prints one line per value, and tables for lists of objects. Control characters of a file's
// strings must not reach the terminal.
void print_for_people(const Json& json, const std::string& indent) {
    for (const auto& [key, value] : json.items()) {
        const bool nested =
            value.is_object() || (value.is_array() && !value.empty() && value[0].is_object());
        if (value.is_structured() && value.empty())
            continue;
        if (!nested) {
            std::printf("%s%-18s %s\n", indent.c_str(), printable(key).c_str(),
                        printable(text_of(value)).c_str());
            continue;
        }
        std::printf("%s%s\n", indent.c_str(), printable(key).c_str());
        if (value.is_object()) {
            print_for_people(value, indent + "  ");
        } else {
            for (const Json& row : value) {
                std::printf("%s", indent.c_str());
                for (const auto& [name, cell] : row.items())
                    std::printf("  %s %s", name.c_str(), printable(text_of(cell)).c_str());
                std::printf("\n");
            }
        }
    }
}

Metadata metadata_of(const Json& json) {
    Metadata metadata;
    if (json.contains("metadata"))
        for (const auto& [key, value] : json["metadata"].items())
            metadata[key] = value.get<std::string>();
    return metadata;
}

Result<Json> describe_tess(const InfoCommand& a) {
    const DecodeOptions& decode = a.texture.decode;
    TESSERA_TRY_ASSIGN(const auto bytes, open_bytes(a.input));
    const auto file = ContainerReader::open(*bytes, OpenOptions{decode.allow_partial});
    if (!file.ok())
        return with_partial_hint(file.status(), *bytes, decode);
    TESSERA_TRY_ASSIGN(const auto tiles, file->summarise_tiles());
    Json json = tess_json(a.input, *file, tiles);
    TESSERA_TRY_ASSIGN(const auto cameras,
                       model_cameras_in(file->metadata()).with_context(a.input));
    for (const corpus::ModelCamera& camera : cameras)
        json["cameras"].push_back({{"name", camera.name}, {"fov", camera.fov}});
    if (file->layers().any()) {
        TESSERA_TRY_ASSIGN(const auto further, open_layers(*bytes, *file, decode));
        json["layers"] = layers_json(*file, further);
        json["lights"] = file->layers().lights.size();
    }
    return json;
}

Result<Json> describe_other(const InfoCommand& a) {
    TESSERA_TRY_ASSIGN(const auto hints, make_hints(a.texture));
    TESSERA_TRY_ASSIGN(const auto opened, open_texture(a.input, hints));
    Json json = texture_json(a.input, opened.source->desc(), opened.description);
    json["kind"] = opened.kind == TextureKind::exr       ? "exr"
                   : opened.kind == TextureKind::raw     ? "raw"
                   : opened.kind == TextureKind::picture ? "picture"
                                                         : "views";
    if (!opened.told.empty())
        json["understood as"] = opened.told;
    return json;
}

// Describes each texture of a .glb under a name of its own.
Status describe_several(InfoCommand a, std::size_t count) {
    Json textures = Json::array();
    const std::string file = a.input;
    for (std::size_t i = 0; i < count; ++i) {
        a.input = file + "#" + std::to_string(i);
        TESSERA_TRY_ASSIGN(textures.emplace_back(), describe_tess(a));
    }
    if (a.json) {
        print_json({{"file", file}, {"textures", std::move(textures)}});
        return {};
    }
    for (const Json& json : textures) {
        if (&json != &textures.front())
            std::printf("\n");
        print_for_people(for_people(json, metadata_of(json)), "");
    }
    return {};
}

Status run(const InfoCommand& a) {
    TESSERA_TRY_ASSIGN(const std::size_t count, texture_count(a.input));
    if (count > 1)
        return describe_several(a, count);
    TESSERA_TRY_ASSIGN(const auto json, kind_of_input(a.input) == TextureKind::tess
                                            ? describe_tess(a)
                                            : describe_other(a));
    if (a.json)
        print_json(json);
    else
        print_for_people(for_people(json, metadata_of(json)), "");
    return {};
}

} // namespace

void add_info_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, InfoCommand& a) {
        c.add_option(
             "file", a.input,
             "Any texture, the URL of a .tess, or - for standard input. Of a .glb with several "
             "textures, scene.glb#1 is the second")
            ->required();
        c.add_flag("--allow-partial", a.texture.decode.allow_partial,
                   "Accept the beginning of a .tess, such as a broken download");
        c.add_flag("--json", a.json, "Print JSON, with all digits");
        add_texture_options(c, a.texture);
        add_network_options(c);
    };
    add_verb<InfoCommand>(
        app, chosen, "info", "Show everything about a file except its texels",
        "For a .tess: size, sample type, options of the encoder, tiles, coarse levels, sections, "
        "metadata. Options accept the words that info prints. Numbers are rounded.\n\n"
        "Examples:\n"
        "  tessera info scene.tess\n"
        "  tessera info scene.exr --json\n"
        "  tessera info https://example.org/scene.tess",
        declare, run);
}

} // namespace tessera
