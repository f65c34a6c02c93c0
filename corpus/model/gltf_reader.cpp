// glTF 2.0, read with tinygltf.
#include "corpus/model/readers.h"

#include <algorithm>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <tiny_gltf.h>

namespace tessera::corpus {
namespace {

using tinygltf::Accessor;

constexpr int deepest = 64;                 // levels of nodes
constexpr std::size_t most_nodes = 100'000; // in the scene, with repetitions

template <class Array> bool has(const Array& array, int index) {
    return index >= 0 && static_cast<std::size_t>(index) < array.size();
}

template <class Array> auto& at(const Array& array, int index) {
    return array[static_cast<std::size_t>(index)];
}

Result<std::span<const unsigned char>> view_bytes(const tinygltf::Model& file, int index,
                                                  const std::string& who) {
    if (!has(file.bufferViews, index))
        return invalid_gltf(who + " has no bufferView");
    const tinygltf::BufferView& view = at(file.bufferViews, index);
    if (!has(file.buffers, view.buffer))
        return invalid_gltf("bufferView " + std::to_string(index) + " has no buffer");
    const auto& data = at(file.buffers, view.buffer).data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        return invalid_gltf("bufferView " + std::to_string(index) + " lies outside its buffer");
    return std::span(data).subspan(view.byteOffset, view.byteLength);
}

template <class Number> double read_number(const unsigned char* from, bool normalized) {
    Number x;
    std::memcpy(&x, from, sizeof x);
    if (!normalized || std::is_floating_point_v<Number>)
        return static_cast<double>(x);
    return std::max(-1.0, static_cast<double>(x) /
                              static_cast<double>(std::numeric_limits<Number>::max()));
}

double read_component(const unsigned char* from, int type, bool normalized) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return read_number<std::int8_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return read_number<std::uint8_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return read_number<std::int16_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return read_number<std::uint16_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return read_number<std::uint32_t>(from, normalized);
    default:
        return read_number<float>(from, false);
    }
}

// Calls put(element, component, number) for every number of the accessor, whose elements must have
// `least` to `most` components. Returns the count of elements.
template <class Put>
Result<std::size_t> read_accessor(const tinygltf::Model& file, int index, int least, int most,
                                  const Put& put) {
    const std::string who = "accessor " + std::to_string(index);
    if (!has(file.accessors, index))
        return invalid_gltf(who + " does not exist");
    const Accessor& a = at(file.accessors, index);
    const int n = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
    const int bytes =
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(a.componentType));
    if (n < least || n > most || bytes <= 0 || bytes > 4)
        return invalid_gltf(who + " has the wrong type");
    if (a.sparse.isSparse)
        return Status(ErrorCode::unsupported, who + " is sparse");
    if (a.count > most_vertices)
        return Status(ErrorCode::unsupported,
                      who + " has more than " + std::to_string(most_vertices) + " elements");
    TESSERA_TRY_ASSIGN(const auto data, view_bytes(file, a.bufferView, who));
    const std::uint64_t element = static_cast<std::uint64_t>(n) * static_cast<unsigned>(bytes);
    std::uint64_t stride = at(file.bufferViews, a.bufferView).byteStride;
    stride = stride == 0 ? element : stride;
    if (a.count != 0 && (a.byteOffset > data.size() || stride < element || stride > 4096 ||
                         (a.count - 1) * stride + element > data.size() - a.byteOffset))
        return invalid_gltf(who + " reaches beyond its bufferView");
    for (std::size_t i = 0; i < a.count; ++i)
        for (int c = 0; c < n; ++c)
            put(i, c,
                read_component(data.data() + a.byteOffset + i * stride +
                                   static_cast<std::size_t>(c) * static_cast<std::size_t>(bytes),
                               a.componentType, a.normalized));
    return a.count;
}

template <class Vector>
Status read_attribute(const tinygltf::Model& file, const tinygltf::Primitive& primitive,
                      const char* name, std::vector<Vector>& values, int least, float otherwise) {
    const auto it = primitive.attributes.find(name);
    if (it == primitive.attributes.end())
        return {};
    if (has(file.accessors, it->second) && at(file.accessors, it->second).count <= most_vertices)
        values.assign(at(file.accessors, it->second).count, Vector(otherwise));
    return read_accessor(
               file, it->second, least, Vector::length(),
               [&](std::size_t i, int c, double x) { values[i][c] = static_cast<float>(x); })
        .status()
        .with_context(name);
}

Status read_indices(const tinygltf::Model& file, const tinygltf::Primitive& primitive,
                    ModelPart& part) {
    std::vector<std::uint32_t> raw;
    if (primitive.indices < 0) {
        for (std::uint32_t i = 0; i < part.positions.size(); ++i)
            raw.push_back(i);
    } else {
        TESSERA_TRY(read_accessor(file, primitive.indices, 1, 1, [&](std::size_t, int, double x) {
            raw.push_back(x >= 0.0 && x < 4294967295.0 ? static_cast<std::uint32_t>(x)
                                                       : UINT32_MAX);
        }));
    }
    const bool strip = primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP;
    if (!strip && primitive.mode != TINYGLTF_MODE_TRIANGLE_FAN) {
        part.indices = std::move(raw);
        return {};
    }
    for (std::size_t i = 2; i < raw.size(); ++i) {
        const std::size_t odd = strip ? i % 2 : 0;
        for (const std::size_t k : {strip ? i - 2 : 0, i - 1 + odd, i - odd})
            part.indices.push_back(raw[k]);
    }
    return {};
}

Result<ModelPart> read_primitive(const tinygltf::Model& file, const SafeGltf& safe,
                                 std::size_t mesh, std::size_t number) {
    const tinygltf::Primitive& primitive = file.meshes[mesh].primitives[number];
    ModelPart part;
    part.name = "mesh " + std::to_string(mesh) + ", primitive " + std::to_string(number);
    // Material 0 is glTF's default.
    if (primitive.material >= 0 && !has(file.materials, primitive.material))
        return invalid_gltf(part.name + " has material " + std::to_string(primitive.material) +
                            " of " + std::to_string(file.materials.size()));
    part.material = static_cast<std::uint32_t>(std::max(primitive.material, -1) + 1);
    if (const auto draco = safe.draco.find({mesh, number}); draco != safe.draco.end()) {
        TESSERA_TRY_ASSIGN(const auto stream, view_bytes(file, draco->second.view, part.name));
        TESSERA_TRY(decode_draco_part(stream, draco->second, part).with_context(part.name));
        return part;
    }
    const auto read = [&](const char* name, auto& values, int least, float otherwise) {
        return read_attribute(file, primitive, name, values, least, otherwise)
            .with_context(part.name);
    };
    TESSERA_TRY(read("POSITION", part.positions, 3, 0.0f));
    TESSERA_TRY(read("NORMAL", part.normals, 3, 0.0f));
    TESSERA_TRY(read("TANGENT", part.tangents, 4, 0.0f));
    TESSERA_TRY(read("TEXCOORD_0", part.uv[0], 2, 0.0f));
    TESSERA_TRY(read("TEXCOORD_1", part.uv[1], 2, 0.0f));
    TESSERA_TRY(read("COLOR_0", part.colours, 3, 1.0f));
    TESSERA_TRY(read_indices(file, primitive, part).with_context(part.name));
    return part;
}

Result<TextureUse> texture_use(const tinygltf::Model& file, int texture, int uv,
                               const std::string& who) {
    TextureUse use;
    if (texture < 0)
        return use;
    if (!has(file.textures, texture))
        return invalid_gltf(who + " has texture " + std::to_string(texture) + " of " +
                            std::to_string(file.textures.size()));
    const tinygltf::Texture& t = at(file.textures, texture);
    if (!has(file.images, t.source))
        return invalid_gltf("texture " + std::to_string(texture) + " has no image");
    if (uv < 0 || uv > 1)
        return Status(ErrorCode::unsupported, who + " uses TEXCOORD_" + std::to_string(uv));
    use.image = t.source;
    use.uv = static_cast<unsigned>(uv);
    if (has(file.samplers, t.sampler)) {
        const auto wrap_of = [](int mode) {
            return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::clamp
                   : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirror
                                                                   : Wrap::repeat;
        };
        use.wrap_u = wrap_of(at(file.samplers, t.sampler).wrapS);
        use.wrap_v = wrap_of(at(file.samplers, t.sampler).wrapT);
    }
    return use;
}

Result<ModelMaterial> read_material(const tinygltf::Model& file, std::size_t number) {
    const tinygltf::Material& from = file.materials[number];
    const std::string who = "material " + std::to_string(number);
    ModelMaterial m;
    const auto& pbr = from.pbrMetallicRoughness;
    if (pbr.baseColorFactor.size() == 4)
        m.base = glm::make_vec4(pbr.baseColorFactor.data());
    m.base = glm::clamp(m.base, 0.0, 1.0);
    m.metal = std::clamp(pbr.metallicFactor, 0.0, 1.0);
    m.roughness = std::clamp(pbr.roughnessFactor, 0.0, 1.0);
    if (from.emissiveFactor.size() == 3)
        m.emission = glm::clamp(glm::dvec3(glm::make_vec3(from.emissiveFactor.data())), 0.0, 1e4);
    if (const auto it = from.extensions.find("KHR_materials_emissive_strength");
        it != from.extensions.end() && it->second.IsObject() &&
        it->second.Has("emissiveStrength") && it->second.Get("emissiveStrength").IsNumber())
        m.emission *= std::clamp(it->second.Get("emissiveStrength").GetNumberAsDouble(), 0.0, 1e4);
    m.normal_scale = std::clamp(from.normalTexture.scale, -10.0, 10.0);
    m.cutoff = from.alphaMode == "MASK" ? std::clamp(from.alphaCutoff, 0.0, 1.0) : 0.0;
    m.double_sided = from.doubleSided;
    const auto use = [&](const auto& texture) {
        return texture_use(file, texture.index, texture.texCoord, who);
    };
    TESSERA_TRY_ASSIGN(m.base_texture, use(pbr.baseColorTexture));
    TESSERA_TRY_ASSIGN(m.metal_roughness_texture, use(pbr.metallicRoughnessTexture));
    TESSERA_TRY_ASSIGN(m.normal_texture, use(from.normalTexture));
    TESSERA_TRY_ASSIGN(m.emission_texture, use(from.emissiveTexture));
    return m;
}

glm::dmat4 transform_of(const tinygltf::Node& node) {
    if (node.matrix.size() == 16)
        return glm::make_mat4(node.matrix.data());
    glm::dmat4 m(1.0);
    if (node.translation.size() == 3)
        m[3] = {node.translation[0], node.translation[1], node.translation[2], 1.0};
    if (node.rotation.size() == 4)
        m *= glm::mat4_cast(glm::normalize(
            glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])));
    if (node.scale.size() == 3)
        for (int c = 0; c < 3; ++c)
            m[c] *= node.scale[static_cast<std::size_t>(c)];
    return m;
}

class GltfScene {
public:
    GltfScene(const tinygltf::Model& file, const SafeGltf& safe, ModelBuilder& builder)
        : file_(file), safe_(safe), builder_(builder) {}

    Status add() {
        if (file_.scenes.empty() && file_.nodes.empty()) { // only a collection of meshes
            for (std::size_t i = 0; i < file_.meshes.size(); ++i)
                TESSERA_TRY(add_mesh(i, glm::dmat4(1.0)));
            return {};
        }
        if (file_.scenes.empty())
            return invalid_gltf("has nodes but no scene");
        const int scene = std::max(file_.defaultScene, 0);
        if (!has(file_.scenes, scene))
            return invalid_gltf("scene " + std::to_string(scene) + " does not exist");
        for (const int node : at(file_.scenes, scene).nodes)
            TESSERA_TRY(add_node(node, glm::dmat4(1.0), 0));
        return {};
    }

private:
    Status add_node(int number, const glm::dmat4& parent, int depth) {
        const std::string who = "node " + std::to_string(number);
        if (!has(file_.nodes, number))
            return invalid_gltf(who + " does not exist");
        if (depth >= deepest)
            return invalid_gltf(who + " is more than " + std::to_string(deepest) +
                                " levels deep, or below itself");
        if (++nodes_ > most_nodes)
            return invalid_gltf("more than " + std::to_string(most_nodes) + " nodes");
        const tinygltf::Node& node = at(file_.nodes, number);
        const glm::dmat4 place = parent * transform_of(node);
        if (node.mesh >= 0) {
            if (!has(file_.meshes, node.mesh))
                return invalid_gltf(who + " has mesh " + std::to_string(node.mesh) + " of " +
                                    std::to_string(file_.meshes.size()));
            TESSERA_TRY(add_mesh(static_cast<std::size_t>(node.mesh), place).with_context(who));
        }
        for (const int child : node.children)
            TESSERA_TRY(add_node(child, place, depth + 1));
        return {};
    }

    Status add_mesh(std::size_t mesh, const glm::dmat4& place) {
        for (std::size_t i = 0; i < file_.meshes[mesh].primitives.size(); ++i) {
            const int mode = file_.meshes[mesh].primitives[i].mode;
            if (mode >= 0 && mode < TINYGLTF_MODE_TRIANGLES)
                continue; // points and lines have no surface
            TESSERA_TRY_ASSIGN(const ModelPart part, read_primitive(file_, safe_, mesh, i));
            TESSERA_TRY(builder_.add(part, place));
        }
        return {};
    }

    const tinygltf::Model& file_;
    const SafeGltf& safe_;
    ModelBuilder& builder_;
    std::size_t nodes_ = 0;
};

// tinygltf calls it for every picture. It keeps the encoded bytes.
bool keep_bytes(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                const unsigned char* bytes, int size, void*) {
    image->image.assign(bytes, bytes + size);
    return true;
}

// The checked parts as a .glb, which tinygltf reads.
std::vector<unsigned char> joined(const SafeGltf& safe) {
    std::vector<unsigned char> out;
    const auto put = [&](std::size_t x) {
        for (int i = 0; i < 4; ++i)
            out.push_back(static_cast<unsigned char>(x >> (8 * i)));
    };
    const auto padded = [](std::size_t x) { return (x + 3) & ~std::size_t{3}; };
    const std::size_t json = padded(safe.json.size()), binary = padded(safe.binary.size());
    put(0x46546C67);
    put(2);
    put(20 + json + (binary != 0 ? 8 + binary : 0));
    put(json);
    put(0x4E4F534A);
    out.insert(out.end(), safe.json.begin(), safe.json.end());
    out.resize(20 + json, ' ');
    if (binary != 0) {
        put(binary);
        put(0x004E4942);
        out.insert(out.end(), safe.binary.begin(), safe.binary.end());
        out.resize(28 + json + binary, 0);
    }
    return out;
}

Status load(const std::string& path, const SafeGltf& safe, tinygltf::Model& file) {
    const std::vector<unsigned char> bytes = joined(safe);
    if (bytes.size() > UINT32_MAX)
        return {ErrorCode::unsupported, "is larger than 4 GB"};
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keep_bytes, nullptr);
    std::string error, warning;
    const bool ok = loader.LoadBinaryFromMemory(&file, &error, &warning, bytes.data(),
                                                static_cast<unsigned>(bytes.size()),
                                                folder_of(path), tinygltf::NO_REQUIRE);
    if (ok)
        return {};
    std::string text = error.empty() ? warning : error;
    std::replace(text.begin(), text.end(), '\n', ' ');
    return invalid_gltf("cannot be read: " + (text.empty() ? "tinygltf states no reason" : text));
}

Status convert(const tinygltf::Model& file, const SafeGltf& safe, ModelBuilder& builder) {
    builder.model().materials.emplace_back(); // glTF's default
    for (std::size_t i = 0; i < file.materials.size(); ++i) {
        TESSERA_TRY_ASSIGN(ModelMaterial material, read_material(file, i));
        builder.model().materials.push_back(material);
    }
    for (std::size_t i = 0; i < file.images.size(); ++i) {
        const tinygltf::Image& image = file.images[i];
        const std::string who = "image " + std::to_string(i) +
                                (image.uri.empty() ? std::string() : " (" + image.uri + ")");
        if (image.image.empty())
            return {ErrorCode::io, who + " is missing"};
        TESSERA_TRY_ASSIGN(Image decoded, decode_image(image.image).with_context(who));
        builder.model().images.push_back(std::move(decoded));
    }
    return GltfScene(file, safe, builder).add();
}

} // namespace

Status read_gltf(const std::string& path, ModelBuilder& builder) {
    TESSERA_TRY_ASSIGN(auto bytes, read_whole_file(path, most_model_bytes));
    TESSERA_TRY_ASSIGN(const SafeGltf safe, make_safe_gltf(std::move(bytes)));
    tinygltf::Model file;
    TESSERA_TRY(load(path, safe, file));
    return convert(file, safe, builder);
}

} // namespace tessera::corpus
