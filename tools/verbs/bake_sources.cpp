#include "tools/verbs/bake_sources.h"

#include "corpus/bake.h"
#include "corpus/model/model.h"
#include "tools/scenes/baked_original.h"
#include "tools/scenes/baked_surface.h"
#include "tools/scenes/scene_name.h"
#include "tools/support/description_text.h"
#include "tools/support/interrupt.h"
#include "tools/support/standard_streams.h"
#include "tools/texture_io/texture_io.h"

namespace tessera {
namespace {

Description colours_of(SampleType type) {
    Description d;
    d.transfer = traits_of(type).is_float ? Transfer::linear : Transfer::srgb;
    d.primaries = Primaries::bt709;
    return d;
}

// Removes a field from the description on the command line and returns its value, "" if it is not
// there.
std::string take(BakeCommand& a, const char* field) {
    auto& fields = a.encode.description;
    const auto entry = fields.find(field);
    if (entry == fields.end())
        return "";
    std::string text = entry->second;
    fields.erase(entry);
    return text;
}

// Every scene lies inside the sphere with diameter 7. A sphere-inside lies in the scene.
Result<Baking> sphere_baking(const BakeCommand& a) {
    for (const auto& [option, given] : {std::pair("--density", a.density.has_value()),
                                        std::pair("--directions", !a.directions.empty())})
        if (given)
            return Status(ErrorCode::bad_argument,
                          std::string(option) + ": needs --proxy mesh; for a sphere use --size");
    TESSERA_TRY_ASSIGN(const auto scene, corpus::find_scene(a.scene));
    TESSERA_TRY_ASSIGN(const auto size,
                       parse_extent_or(a.texture.size, "--size", scene.default_size));
    const std::uint64_t seed = a.seed.value_or(usual_bake_seed);
    Description said;
    if (const auto proxy = a.encode.description.find("proxy");
        proxy != a.encode.description.end() && proxy->second.starts_with("sphere-inside"))
        TESSERA_TRY(set_description_field(said, "proxy", proxy->second));
    TESSERA_TRY_ASSIGN(
        auto texels, corpus::make_baked_source(a.scene, size, a.samples, seed, baked_window(said)));
    Baking baking;
    baking.description = colours_of(texels->desc().type);
    baking.description.proxy = Proxy::sphere;
    baking.description.sphere_radius = 3.5f;
    baking.description.surface_map = SurfaceMap::sphere_longitude_latitude;
    baking.description.angular_map = AngularMap::hemisphere_alpha_beta;
    baking.facts = {{"scene", a.scene},
                    {"samples per texel", std::to_string(a.samples)},
                    {"seed", std::to_string(seed)}};
    baking.json = {{"scene", a.scene}, {"samples_per_texel", a.samples}, {"seed", seed}};
    baking.texels = std::move(texels);
    return baking;
}

Result<Baking> mesh_baking(const BakeCommand& a, const std::string& map) {
    TESSERA_TRY(check_mesh_options(a));
    SurfaceBake bake{a.scene, {}, {}, a.samples};
    TESSERA_TRY_ASSIGN(bake.detail, surface_wish(a));
    TESSERA_TRY_ASSIGN(
        bake.map, parse_octahedral_map(map.empty() ? "auto" : map).with_context("--angular-map"));
    TESSERA_TRY_ASSIGN(BakedSurface baked, bake_surface(bake));
    Baking baking;
    baking.description = colours_of(baked.texels->desc().type);
    baking.description.proxy = Proxy::mesh;
    baking.description.surface_map = SurfaceMap::mesh_uv;
    baking.description.angular_map = baked.map;
    baking.tile = baked.detail.tile;
    baking.facts = scene_facts(a, baked.detail.density, baked.background);
    baking.json = {{"scene", a.scene},
                   {"samples_per_texel", a.samples},
                   {"texels_per_unit", baked.detail.density},
                   {"angular_map", name_of(baked.map)},
                   {"triangles", baked.triangles},
                   {"charts", baked.charts},
                   {"mesh_bytes", baked.mesh.size()}};
    baking.remark = std::to_string(baked.triangles) + " triangles in " +
                    human_bytes(baked.mesh.size()) + ", " + std::to_string(baked.charts) +
                    " charts, " + format_number(baked.detail.density, 3) + " texels per unit, " +
                    name_of(baked.map);
    baking.mesh = std::move(baked.mesh);
    baking.texels = std::move(baked.texels);
    baking.mask = std::move(baked.mask);
    return baking;
}

} // namespace

Status check_mesh_options(const BakeCommand& a) {
    if (!a.texture.size.empty())
        return {ErrorCode::bad_argument,
                "--size: with --proxy mesh the size comes from --density and "
                "--directions"};
    if (a.seed)
        return {ErrorCode::bad_argument,
                "--seed: with --proxy mesh all texels have the same sample pattern"};
    if (a.encode.description.contains("surface-map"))
        return {ErrorCode::bad_argument, "--surface-map: --proxy mesh always has mesh-uv"};
    if (!is_compressed(a))
        return {ErrorCode::bad_argument,
                a.output + ": --proxy mesh needs a .tess output, which holds the mesh"};
    return {};
}

std::vector<std::pair<std::string, std::string>> scene_facts(const BakeCommand& a, double density,
                                                             const std::string& background) {
    return {{"scene", a.scene},
            {"samples per texel", std::to_string(a.samples)},
            {"texels per unit", format_number(density, 3)},
            {"background", background}};
}

Result<corpus::SurfaceWish> surface_wish(const BakeCommand& a) {
    corpus::SurfaceWish wish;
    wish.density = a.density;
    if (!a.directions.empty()) {
        const auto size = parse_extent("1x1x" + a.directions);
        if (!size.ok())
            return Status(ErrorCode::bad_argument,
                          "--directions: '" + a.directions + "' is not SxT such as 16x16");
        wish.directions = {(*size)[axis_s], (*size)[axis_t]};
    }
    if (!a.encode.tile.empty()) {
        TESSERA_TRY_ASSIGN(wish.tile, parse_extent(a.encode.tile).with_context("--tile"));
    }
    return wish;
}

Metadata metadata_of(const std::vector<std::pair<std::string, std::string>>& facts) {
    Metadata metadata;
    for (const auto& [name, value] : facts) {
        std::string key = name;
        key[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(key[0])));
        metadata[key] = value;
    }
    return metadata;
}

bool is_compressed(const BakeCommand& a) {
    return a.output == standard_stream || kind_of(a.output) == TextureKind::tess;
}

Status check_compressed_output(const BakeCommand& a) {
    TESSERA_TRY(check_glb_options(a.glb, a.output));
    if (!is_glb_name(a.output))
        return check_tess_output(a.encode, a.output);
    if (a.encode.resume)
        return {ErrorCode::bad_argument,
                "--resume: a .glb has no journal; bake a .tess and convert it"};
    return check_output_path(a.output);
}

Status check_has_glb_mesh(const BakeCommand& a) {
    const auto proxy = a.encode.description.find("proxy");
    if (!is_glb_name(a.output) || corpus::is_model_path(a.scene) ||
        (proxy != a.encode.description.end() && proxy->second == "mesh"))
        return {};
    return {ErrorCode::bad_argument, a.output + ": " + needs_mesh};
}

Result<GlbReport> write_baked_glb(const BakeCommand& a, std::span<const std::byte> tess) {
    const GlbInput input{a.output, tess};
    return write_glb_output({&input, 1}, a.output, a.glb,
                            {.verb = "tessera bake",
                             .threads = a.texture.threads,
                             .quiet = a.texture.quiet || a.encode.json});
}

Result<Baking> make_baking(BakeCommand& a, ModelToBake* model) {
    const auto proxy = a.encode.description.find("proxy");
    const std::string word = proxy != a.encode.description.end()
                                 ? proxy->second
                                 : (model != nullptr ? "mesh" : "sphere");
    if (model != nullptr && word != "mesh")
        return Status(ErrorCode::bad_argument,
                      "--proxy " + word +
                          ": the texture of a model lies on the model, --proxy mesh");
    if (model == nullptr) {
        TESSERA_TRY(check_scene(a.scene));
        TESSERA_TRY(check_no_model_options(a.model));
    }
    if (word == "mesh" || word == "sphere")
        take(a, "proxy"); // others only change the description
    if (word != "mesh")
        return sphere_baking(a);
    const std::string map = take(a, "angular-map");
    return model != nullptr ? model_baking(a, std::move(*model), map) : mesh_baking(a, map);
}

} // namespace tessera
