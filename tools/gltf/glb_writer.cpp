#include "tools/gltf/glb_writer.h"

#include "format/layers.h"
#include "format/output_file.h"
#include "tools/gltf/mean_picture.h"
#include "tools/picture/picture_encoders.h"
#include "tools/support/parse.h"
#include "tools/texture_io/texture_io.h"
#include "tools/view/mesh_renderer.h"
#include "tools/view/render_stage.h"

#include <algorithm>
#include <memory>

namespace tessera {
namespace {

// Numbers of glTF 2.0.
constexpr int linear_filter = 9729, linear_mipmaps = 9987, clamp_to_edge = 33071;
// Of 255. From this alpha on, a pixel counts as one that hides what is behind it: coding changes full
// opacity by a few steps near the edges of charts.
constexpr int hiding_alpha = 230;

Result<std::vector<std::byte>> encode_mean(const MeanPicture& picture, bool is_jpeg,
                                           const GlbOptions& options) {
    const PixelSize size{picture.width, picture.height, picture.channels()};
    return is_jpeg ? encode_jpeg(size, picture.pixels, *options.jpeg_quality)
                   : encode_png(size, picture.pixels);
}

// The largest side of the layers along `axis`, halved until it fits.
std::uint32_t picture_side(const Stage& stage, std::size_t axis, std::uint32_t most) {
    std::uint32_t side = stage.desc.size[axis];
    for (const OpenLayerFile& layer : stage.layers)
        if (layer.info.role != LayerRole::environment)
            side = std::max(side, layer.decoder->desc().size[axis]);
    while (side > most)
        side = (side + 1) / 2;
    return side;
}

Result<MeanPicture> mean_picture(Stage& stage, const SurfaceMesh& mesh, const GlbOptions& options,
                                 const RenderOptions& drawing) {
    return draw_mean_picture(stage.subject(), mesh, stage.desc.type,
                             {picture_side(stage, axis_u, options.picture_side),
                              picture_side(stage, axis_v, options.picture_side)},
                             drawing);
}

bool has_layer(const Stage& stage, LayerRole role) {
    return std::any_of(stage.layers.begin(), stage.layers.end(),
                       [&](const OpenLayerFile& layer) { return layer.info.role == role; });
}

// Per triangle, whether it touches a pixel that does not hide what is behind it.
std::vector<bool> blended_triangles(const SurfaceMesh& mesh, const MeanPicture& picture) {
    const glm::dvec2 sides(picture.width, picture.height);
    std::vector<bool> blended;
    for (const auto& [a, b, c] : mesh.triangles) {
        bool touches = false;
        visit_covered_texels(
            {glm::dvec2(mesh.uv[a]) * sides, glm::dvec2(mesh.uv[b]) * sides,
             glm::dvec2(mesh.uv[c]) * sides},
            {picture.width, picture.height}, [&](std::uint32_t u, std::uint32_t v) {
                const std::size_t at = std::size_t{v} * picture.width + u;
                touches |= std::to_integer<int>(picture.pixels[4 * at + 3]) < hiding_alpha;
            });
        blended.push_back(touches);
    }
    return blended;
}

// What one .tess file becomes, but for its bytes.
struct Surface {
    GltfMesh mesh{};
    MeanPicture picture{};
    bool has_holes = false;
    std::vector<bool> blended{}; // per triangle; empty: none is
    std::unique_ptr<ByteSource> bytes{};
};

Status lies_on_no_mesh(const GlbInput& input) {
    return {ErrorCode::unsupported, input.name + ": does not lie on a mesh; " + needs_mesh};
}

Status check_has_mesh(const GlbInput& input) {
    std::unique_ptr<ByteSource> source;
    if (!input.bytes.empty()) {
        source = wrap_memory(input.bytes);
    } else {
        TESSERA_TRY_ASSIGN(source, open_tess_bytes(input.name, "convert"));
    }
    TESSERA_TRY_ASSIGN(const auto container, ContainerReader::open(*source));
    return container.description().proxy == Proxy::mesh ? Status() : lies_on_no_mesh(input);
}

Result<Surface> open_surface(const GlbInput& input, const GlbOptions& options) {
    StageRequest request;
    request.file = input.name;
    request.bytes = input.bytes;
    RenderOptions drawing;
    drawing.threads = options.threads;
    drawing.progress = options.progress;
    TESSERA_TRY_ASSIGN(Stage stage, set_up_stage(request, drawing));
    TESSERA_TRY_ASSIGN(const auto on_mesh, mesh_surface(stage.decoder->container()));
    if (!on_mesh)
        return lies_on_no_mesh(input);
    Surface surface{.mesh = {on_mesh->mesh, gltf_tangents(on_mesh->mesh)}};
    TESSERA_TRY_ASSIGN(surface.picture, mean_picture(stage, on_mesh->mesh, options, drawing));
    const bool blends = has_layer(stage, LayerRole::opacity);
    if (surface.picture.has_alpha && blends)
        surface.blended = blended_triangles(on_mesh->mesh, surface.picture);
    surface.has_holes =
        surface.picture.has_alpha && (!blends || has_layer(stage, LayerRole::coverage));
    surface.bytes = std::move(stage.bytes);
    return surface;
}

Json unlit_material(std::size_t texture, const std::string& alpha_mode) {
    Json material;
    Json& base = material["pbrMetallicRoughness"];
    base["baseColorTexture"]["index"] = texture;
    base["metallicFactor"] = 0;
    if (!alpha_mode.empty())
        material["alphaMode"] = alpha_mode;
    if (alpha_mode == "MASK")
        material["alphaCutoff"] = least_coverage;
    material["extensions"]["KHR_materials_unlit"] = Json::object();
    return material;
}

// Adds the triangles that blend, or those that do not, if there are any.
Status add_part(GlbFile& glb, Json& primitives, const Surface& surface, bool blends,
                std::size_t texture, MeshCompression compression) {
    GltfMesh part;
    if (!surface.blended.empty()) {
        part = part_of(surface.mesh, surface.blended, blends);
        if (part.mesh.triangles.empty())
            return {};
    } else if (blends) {
        return {};
    }
    TESSERA_TRY_ASSIGN(
        Json primitive,
        add_primitive(glb, surface.blended.empty() ? surface.mesh : part, compression));
    primitive["material"] = glb.add_material(unlit_material(texture, blends              ? "BLEND"
                                                                     : surface.has_holes ? "MASK"
                                                                                         : ""));
    primitives.push_back(std::move(primitive));
    return {};
}

// name: of the node and the mesh; empty: they have none.
Status add_surface(GlbFile& glb, const Surface& surface, const std::string& name,
                   const GlbOptions& options, GlbReport& report) {
    const bool is_jpeg = options.jpeg_quality && !surface.picture.has_alpha;
    TESSERA_TRY_ASSIGN(const auto encoded, encode_mean(surface.picture, is_jpeg, options));
    const std::size_t texture = report.textures;
    const std::uint64_t before = glb.chunk_bytes();
    Json mesh = Json::object();
    if (!name.empty())
        mesh["name"] = name;
    Json& primitives = mesh["primitives"];
    for (const bool blends : {false, true})
        TESSERA_TRY(add_part(glb, primitives, surface, blends, texture, options.mesh));
    report.mesh += glb.chunk_bytes() - before;
    Json& json = glb.json;
    json["images"].push_back({{"bufferView", glb.add_view(encoded)},
                              {"mimeType", is_jpeg ? "image/jpeg" : "image/png"}});
    glb.add_texture({{"sampler", 0}, {"source", texture}}, *surface.bytes);
    Json node = {{"mesh", texture}};
    if (!name.empty())
        node["name"] = name;
    json["meshes"].push_back(std::move(mesh));
    json["scenes"][0]["nodes"].push_back(texture);
    json["nodes"].push_back(std::move(node));
    ++report.textures;
    report.picture += encoded.size();
    report.texture += surface.bytes->size();
    report.width = surface.picture.width;
    report.height = surface.picture.height;
    report.picture_kind = is_jpeg ? "JPEG" : "PNG";
    return {};
}

} // namespace

Result<GlbReport> write_glb(std::span<const GlbInput> inputs, const std::string& output,
                            const GlbOptions& options) {
    for (const GlbInput& input : inputs)
        TESSERA_TRY(check_has_mesh(input));
    GlbFile glb;
    glb.json["scene"] = 0;
    glb.json["samplers"][0] = {{"magFilter", linear_filter},
                               {"minFilter", linear_mipmaps},
                               {"wrapS", clamp_to_edge},
                               {"wrapT", clamp_to_edge}};
    GlbReport report;
    std::vector<std::unique_ptr<ByteSource>> files;
    for (const GlbInput& input : inputs) {
        TESSERA_TRY_ASSIGN(Surface surface, open_surface(input, options));
        const std::string name = inputs.size() > 1 ? to_path(input.name).stem().string() : "";
        TESSERA_TRY(add_surface(glb, surface, name, options, report));
        files.push_back(std::move(surface.bytes));
    }
    TESSERA_TRY_ASSIGN(report.file, glb.write(output));
    return report;
}

std::string to_string(const GlbReport& r) {
    const std::string many = std::to_string(r.textures);
    if (r.textures != 1)
        return human_bytes(r.file) + ": " + many + " meshes " + human_bytes(r.mesh) + ", " + many +
               " pictures " + human_bytes(r.picture) + ", " + many + " textures " +
               human_bytes(r.texture);
    return human_bytes(r.file) + ": mesh " + human_bytes(r.mesh) + ", " + r.picture_kind + " of " +
           std::to_string(r.width) + "x" + std::to_string(r.height) + " " + human_bytes(r.picture) +
           ", texture " + human_bytes(r.texture);
}

Json to_json(const GlbReport& r) {
    Json json = {{"bytes", r.file}, {"mesh_bytes", r.mesh}};
    if (r.textures == 1) {
        json["picture"] = r.picture_kind;
        json["picture_size"] = std::to_string(r.width) + "x" + std::to_string(r.height);
    } else {
        json["textures"] = r.textures;
    }
    json["picture_bytes"] = r.picture;
    json["texture_bytes"] = r.texture;
    return json;
}

} // namespace tessera
