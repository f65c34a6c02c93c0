#include "tools/gltf/glb_writer.h"

#include "format/metadata.h"
#include "format/output_file.h"
#include "tools/gltf/glb_mesh.h"
#include "tools/gltf/mean_picture.h"
#include "tools/http/glb_payload.h"
#include "tools/picture/picture_encoders.h"
#include "tools/support/copy_bytes.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/texture_io/texture_io.h"
#include "tools/view/mesh_renderer.h"
#include "tools/view/render_stage.h"

#include <algorithm>
#include <bit>
#include <glm/common.hpp>

namespace tessera {
namespace {

// Numbers of glTF 2.0.
constexpr int array_buffer = 34962, element_array_buffer = 34963, type_float = 5126,
              type_u16 = 5123, type_u32 = 5125, linear_filter = 9729, linear_mipmaps = 9987,
              clamp_to_edge = 33071;
constexpr std::uint64_t most_glb_bytes = 0xFFFFFFFF;

void append_word(std::vector<std::byte>& out, std::uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8)
        out.push_back(static_cast<std::byte>(word >> shift));
}

template <class Vector> std::vector<std::byte> bytes_of(const std::vector<Vector>& values) {
    std::vector<std::byte> out;
    for (const Vector& value : values)
        for (glm::length_t c = 0; c < Vector::length(); ++c)
            append_word(out, std::bit_cast<std::uint32_t>(value[c] + 0.0f)); // no -0
    return out;
}

Json as_json(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

// The JSON and the binary chunk, but for the .tess file at its end.
class GlbFile {
public:
    GlbFile() {
        json = {{"asset",
                 {{"version", "2.0"}, {"generator", std::string("Tessera ") + library_version}}},
                {"extensionsUsed", Json::array({"KHR_materials_unlit", glb_extension})}};
    }

    // Returns the index of the buffer view.
    std::size_t add_view(std::span<const std::byte> bytes, int target = 0) {
        Json view = {{"buffer", 0}, {"byteOffset", chunk_.size()}, {"byteLength", bytes.size()}};
        if (target != 0)
            view["target"] = target;
        views_.push_back(std::move(view));
        chunk_.insert(chunk_.end(), bytes.begin(), bytes.end());
        chunk_.resize((chunk_.size() + 3) / 4 * 4); // accessors begin at multiples of 4
        return views_.size() - 1;
    }
    std::size_t add_accessor(Json accessor) {
        json["accessors"].push_back(std::move(accessor));
        return json["accessors"].size() - 1;
    }

    // Writes everything, with the .tess file as the last buffer view, which the texture names.
    Result<std::uint64_t> write(ByteSource& tess, const std::string& output) {
        json["textures"][0]["extensions"][glb_extension] = {{"bufferView", views_.size()},
                                                            {"mimeType", tess_mime_type}};
        views_.push_back(
            {{"buffer", 0}, {"byteOffset", chunk_.size()}, {"byteLength", tess.size()}});
        json["bufferViews"] = views_;
        const std::uint64_t chunk_bytes = (chunk_.size() + tess.size() + 3) / 4 * 4;
        json["buffers"][0]["byteLength"] = chunk_bytes;
        std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const std::uint64_t all = 12 + 8 + text.size() + 8 + chunk_bytes;
        if (all > most_glb_bytes)
            return Status(ErrorCode::unsupported, output + ": would have " + human_bytes(all) +
                                                      ", but a .glb has at most 4 GiB");
        std::vector<std::byte> head;
        for (const std::uint64_t word : {std::uint64_t{0x46546C67}, std::uint64_t{2}, all,
                                         std::uint64_t{text.size()}, std::uint64_t{0x4E4F534A}})
            append_word(head, static_cast<std::uint32_t>(word));
        const auto letters = std::as_bytes(std::span(text));
        head.insert(head.end(), letters.begin(), letters.end());
        append_word(head, static_cast<std::uint32_t>(chunk_bytes));
        append_word(head, 0x004E4942);
        TESSERA_TRY(make_parent_folders(output));
        TESSERA_TRY_ASSIGN(OutputFile file, OutputFile::create(output));
        TESSERA_TRY(file.append(head));
        TESSERA_TRY(file.append(chunk_));
        TESSERA_TRY(copy_bytes(tess, file));
        TESSERA_TRY(file.append(std::vector<std::byte>(all - file.appended())));
        TESSERA_TRY(file.commit());
        return all;
    }

    Json json;

private:
    Json views_ = Json::array();
    std::vector<std::byte> chunk_;
};

Json float_accessor(const char* type, std::size_t count) {
    return {{"componentType", type_float}, {"count", count}, {"type", type}};
}

// Returns the primitive without its material.
Json add_plain_mesh(GlbFile& glb, const SurfaceMesh& mesh) {
    const std::size_t count = mesh.positions.size();
    Json primitive;
    const auto add = [&](const char* name, const char* type, const std::vector<std::byte>& bytes) {
        Json accessor = float_accessor(type, count);
        accessor["bufferView"] = glb.add_view(bytes, array_buffer);
        if (std::string(name) == "POSITION") {
            glm::vec3 low = mesh.positions.front(), high = low;
            for (const glm::vec3& p : mesh.positions) {
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
            accessor["min"] = as_json(low + 0.0f);
            accessor["max"] = as_json(high + 0.0f);
        }
        primitive["attributes"][name] = glb.add_accessor(std::move(accessor));
    };
    add("POSITION", "VEC3", bytes_of(mesh.positions));
    add("NORMAL", "VEC3", bytes_of(mesh.normals));
    add("TANGENT", "VEC4", bytes_of(gltf_tangents(mesh)));
    add("TEXCOORD_0", "VEC2", bytes_of(mesh.uv));
    const bool is_small = count <= 0xFFFF; // the index 0xFFFF itself is not allowed
    std::vector<std::byte> indices;
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t corner : triangle)
            for (int shift = 0; shift < (is_small ? 16 : 32); shift += 8)
                indices.push_back(static_cast<std::byte>(corner >> shift));
    primitive["indices"] =
        glb.add_accessor({{"bufferView", glb.add_view(indices, element_array_buffer)},
                          {"componentType", is_small ? type_u16 : type_u32},
                          {"count", 3 * mesh.triangles.size()},
                          {"type", "SCALAR"}});
    return primitive;
}

Result<Json> add_draco_mesh(GlbFile& glb, const SurfaceMesh& mesh) {
    constexpr const char* extension = "KHR_draco_mesh_compression";
    TESSERA_TRY_ASSIGN(const DracoPrimitive draco, compress_primitive(mesh, gltf_tangents(mesh)));
    glb.json["extensionsUsed"].push_back(extension);
    glb.json["extensionsRequired"].push_back(extension);
    Json primitive;
    for (const auto& [name, type] :
         {std::pair("POSITION", "VEC3"), std::pair("NORMAL", "VEC3"), std::pair("TANGENT", "VEC4"),
          std::pair("TEXCOORD_0", "VEC2")}) {
        Json accessor = float_accessor(type, draco.vertices);
        if (std::string(name) == "POSITION") {
            accessor["min"] = as_json(draco.low + 0.0f);
            accessor["max"] = as_json(draco.high + 0.0f);
        }
        primitive["attributes"][name] = glb.add_accessor(std::move(accessor));
    }
    primitive["indices"] =
        glb.add_accessor({{"componentType", draco.vertices <= 0xFFFF ? type_u16 : type_u32},
                          {"count", 3 * draco.triangles},
                          {"type", "SCALAR"}});
    primitive["extensions"][extension] = {{"bufferView", glb.add_view(draco.stream)},
                                          {"attributes", Json(draco.attributes)}};
    return primitive;
}

Result<std::vector<std::byte>> encode_mean(const MeanPicture& picture, const GlbOptions& options) {
    const PixelSize size{picture.width, picture.height, picture.channels()};
    return options.jpeg_quality && !picture.has_alpha
               ? encode_jpeg(size, picture.pixels, *options.jpeg_quality)
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

void add_scene(GlbFile& glb, Json primitive, std::size_t picture_view, const char* mime,
               bool has_holes) {
    primitive["material"] = 0;
    Json& json = glb.json;
    json["scene"] = 0;
    json["scenes"][0]["nodes"][0] = 0;
    json["nodes"][0]["mesh"] = 0;
    json["meshes"][0]["primitives"][0] = std::move(primitive);
    Json& material = json["materials"][0];
    Json& base = material["pbrMetallicRoughness"];
    base["baseColorTexture"]["index"] = 0;
    base["metallicFactor"] = 0;
    if (has_holes) {
        material["alphaMode"] = "MASK";
        material["alphaCutoff"] = least_coverage;
    }
    material["extensions"]["KHR_materials_unlit"] = Json::object();
    json["textures"][0] = {{"sampler", 0}, {"source", 0}};
    json["samplers"][0] = {{"magFilter", linear_filter},
                           {"minFilter", linear_mipmaps},
                           {"wrapS", clamp_to_edge},
                           {"wrapT", clamp_to_edge}};
    json["images"][0] = {{"bufferView", picture_view}, {"mimeType", mime}};
}

Status check_has_mesh(const std::string& input, std::span<const std::byte> bytes) {
    std::unique_ptr<ByteSource> source;
    if (!bytes.empty()) {
        source = wrap_memory(bytes);
    } else {
        TESSERA_TRY_ASSIGN(source, open_tess_bytes(input, "convert"));
    }
    TESSERA_TRY_ASSIGN(const auto container, ContainerReader::open(*source));
    if (container.description().proxy == Proxy::mesh)
        return {};
    return {ErrorCode::unsupported, input + ": does not lie on a mesh; " + needs_mesh};
}

} // namespace

Result<GlbReport> write_glb(const std::string& input, std::span<const std::byte> bytes,
                            const std::string& output, const GlbOptions& options) {
    TESSERA_TRY(check_has_mesh(input, bytes));
    StageRequest request;
    request.file = input;
    request.bytes = bytes;
    RenderOptions drawing;
    drawing.threads = options.threads;
    drawing.progress = options.progress;
    TESSERA_TRY_ASSIGN(Stage stage, set_up_stage(request, drawing));
    TESSERA_TRY_ASSIGN(const auto surface, mesh_surface(stage.decoder->container()));
    const SurfaceMesh& mesh = surface->mesh;
    TESSERA_TRY_ASSIGN(const MeanPicture picture, mean_picture(stage, mesh, options, drawing));
    TESSERA_TRY_ASSIGN(const auto encoded, encode_mean(picture, options));
    const bool is_jpeg = options.jpeg_quality && !picture.has_alpha;
    GlbReport report{.picture = encoded.size(),
                     .texture = stage.bytes->size(),
                     .width = picture.width,
                     .height = picture.height,
                     .picture_kind = is_jpeg ? "JPEG" : "PNG"};
    GlbFile glb;
    Json primitive;
    if (options.draco) {
        TESSERA_TRY_ASSIGN(primitive, add_draco_mesh(glb, mesh));
    } else {
        primitive = add_plain_mesh(glb, mesh);
    }
    const std::size_t picture_view = glb.add_view(encoded);
    add_scene(glb, std::move(primitive), picture_view, is_jpeg ? "image/jpeg" : "image/png",
              picture.has_alpha);
    TESSERA_TRY_ASSIGN(report.file, glb.write(*stage.bytes, output));
    for (const Json& view : glb.json["bufferViews"])
        report.mesh += view["byteLength"].get<std::uint64_t>();
    report.mesh -= report.picture + report.texture;
    return report;
}

std::string to_string(const GlbReport& r) {
    return human_bytes(r.file) + ": mesh " + human_bytes(r.mesh) + ", " + r.picture_kind + " of " +
           std::to_string(r.width) + "x" + std::to_string(r.height) + " " + human_bytes(r.picture) +
           ", texture " + human_bytes(r.texture);
}

Json to_json(const GlbReport& r) {
    return {{"bytes", r.file},
            {"mesh_bytes", r.mesh},
            {"picture", r.picture_kind},
            {"picture_size", std::to_string(r.width) + "x" + std::to_string(r.height)},
            {"picture_bytes", r.picture},
            {"texture_bytes", r.texture}};
}

} // namespace tessera
