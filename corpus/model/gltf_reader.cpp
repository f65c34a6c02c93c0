// glTF 2.0, read with tinygltf.
#include "corpus/model/gltf_cameras.h"
#include "corpus/model/gltf_materials.h"
#include "corpus/model/gltf_pose.h"

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>
#include <glm/vector_relational.hpp>

namespace tessera::corpus {
namespace {

constexpr std::size_t most_nodes = 100'000; // in the scene, with repetitions

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

// `sets`: of each material.
Result<ModelPart> read_primitive(const tinygltf::Model& file, const SafeGltf& safe,
                                 const std::vector<UvSets>& sets, std::size_t mesh,
                                 std::size_t number, bool has_skin) {
    const tinygltf::Primitive& primitive = file.meshes[mesh].primitives[number];
    ModelPart part;
    part.name = "mesh " + std::to_string(mesh) + ", primitive " + std::to_string(number);
    // Material 0 is glTF's default.
    if (primitive.material >= 0 && !has(file.materials, primitive.material))
        return invalid_gltf(part.name + " has material " + std::to_string(primitive.material) +
                            " of " + std::to_string(file.materials.size()));
    part.material = static_cast<std::uint32_t>(std::max(primitive.material, -1) + 1);
    const Attributes attributes{.uv = sets[part.material], .has_skin = has_skin};
    if (const auto draco = safe.draco.find({mesh, number}); draco != safe.draco.end()) {
        TESSERA_TRY_ASSIGN(const auto stream, view_bytes(file, draco->second.view, part.name));
        TESSERA_TRY(
            decode_draco_part(stream, draco->second, attributes, part).with_context(part.name));
        return part;
    }
    const auto read = [&](const std::string& name, auto& values, int least, float otherwise) {
        return read_attribute(file, primitive.attributes, name, values, least, otherwise)
            .with_context(part.name);
    };
    TESSERA_TRY(read_attributes(attributes, part, read));
    TESSERA_TRY(read_indices(file, primitive, part).with_context(part.name));
    return part;
}

class GltfScene {
public:
    // `sets`: of each material.
    GltfScene(const tinygltf::Model& file, const SafeGltf& safe, const std::vector<UvSets>& sets,
              ModelBuilder& builder)
        : file_(file), safe_(safe), sets_(sets), builder_(builder), skins_(file) {}

    Status add() {
        if (file_.scenes.empty() && file_.nodes.empty()) { // only a collection of meshes
            for (std::size_t i = 0; i < file_.meshes.size(); ++i)
                TESSERA_TRY(add_mesh(i, glm::dmat4(1.0), {}));
            return {};
        }
        TESSERA_TRY(add_roots());
        if (skipped_ > 0 && builder_.model().triangles.empty())
            return {ErrorCode::unsupported, "has only points and lines, and no triangles"};
        note_skipped();
        std::move(cameras_).finish(builder_.model());
        return {};
    }

private:
    // The nodes of the scene. Without a scene, all nodes that are below no other.
    Status add_roots() {
        if (file_.scenes.empty()) {
            const std::vector<int> parents = parents_of(file_);
            for (std::size_t i = 0; i < parents.size(); ++i)
                if (parents[i] < 0)
                    TESSERA_TRY(add_node(static_cast<int>(i), glm::dmat4(1.0), 0));
            return {};
        }
        const int scene = std::max(file_.defaultScene, 0);
        if (!has(file_.scenes, scene))
            return invalid_gltf("scene " + std::to_string(scene) + " does not exist");
        for (const int node : at(file_.scenes, scene).nodes)
            TESSERA_TRY(add_node(node, glm::dmat4(1.0), 0));
        return {};
    }

    Status add_node(int number, const glm::dmat4& parent, int depth) {
        const std::string who = "node " + std::to_string(number);
        if (!has(file_.nodes, number))
            return invalid_gltf(who + " does not exist");
        if (depth >= deepest_node)
            return invalid_gltf(who + " is more than " + std::to_string(deepest_node) +
                                " levels deep, or below itself");
        if (++nodes_ > most_nodes)
            return invalid_gltf("more than " + std::to_string(most_nodes) + " nodes");
        const tinygltf::Node& node = at(file_.nodes, number);
        const glm::dmat4 place = parent * transform_of(node);
        add_lamp(node, place);
        cameras_.add(file_, node, place);
        if (node.mesh >= 0) {
            if (!has(file_.meshes, node.mesh))
                return invalid_gltf(who + " has mesh " + std::to_string(node.mesh) + " of " +
                                    std::to_string(file_.meshes.size()));
            TESSERA_TRY(add_instances(node, place).with_context(who));
        }
        for (const int child : node.children)
            TESSERA_TRY(add_node(child, place, depth + 1));
        return {};
    }

    // Intensities beyond these limits are mistakes of an exporter.
    void add_lamp(const tinygltf::Node& node, const glm::dmat4& place) {
        const auto it = node.extensions.find("KHR_lights_punctual");
        if (it == node.extensions.end() || !it->second.Has("light") ||
            !it->second.Get("light").IsNumber() ||
            !has(file_.lights, it->second.Get("light").GetNumberAsInt()))
            return;
        const tinygltf::Light& light = at(file_.lights, it->second.Get("light").GetNumberAsInt());
        ModelLamp lamp;
        using Kind = ModelLamp::Kind;
        lamp.kind = light.type == "directional" ? Kind::directional
                    : light.type == "spot"      ? Kind::spot
                                                : Kind::point;
        lamp.position = glm::dvec3(place[3]);
        const glm::dvec3 way = glm::dmat3(place) * glm::dvec3(0.0, 0.0, -1.0);
        const double length = glm::length(way);
        glm::dvec3 colour(1.0);
        if (light.color.size() == 3)
            colour = glm::make_vec3(light.color.data());
        lamp.strength = glm::clamp(colour, 0.0, 1.0) * std::clamp(light.intensity, 0.0, 1e9);
        const bool is_sound = length > 1e-12 && length < 1e12 && std::isfinite(light.intensity) &&
                              glm::all(glm::lessThan(glm::abs(lamp.position), glm::dvec3(1e12)));
        if (!is_sound || lamp.strength == glm::dvec3(0.0)) {
            ++dark_;
            return;
        }
        lamp.direction = way / length;
        lamp.range = std::clamp(light.range, 0.0, 1e12);
        lamp.inner_cosine = std::cos(std::clamp(light.spot.innerConeAngle, 0.0, 1.5707963));
        lamp.outer_cosine = std::cos(std::clamp(light.spot.outerConeAngle, 0.0, 1.5707963));
        builder_.model().lamps.push_back(lamp);
    }

    // The mesh of a node, once for each of its instances (EXT_mesh_gpu_instancing).
    Status add_instances(const tinygltf::Node& node, const glm::dmat4& place) {
        const auto mesh = static_cast<std::size_t>(node.mesh);
        const auto it = node.extensions.find("EXT_mesh_gpu_instancing");
        if (it == node.extensions.end())
            return add_mesh(mesh, place, node);
        std::map<std::string, int> attributes;
        if (it->second.Has("attributes") && it->second.Get("attributes").IsObject())
            for (const std::string& name : it->second.Get("attributes").Keys())
                if (const tinygltf::Value& index = it->second.Get("attributes").Get(name);
                    index.IsNumber())
                    attributes[name] = index.GetNumberAsInt();
        std::vector<glm::vec3> translations, scales;
        std::vector<glm::vec4> rotations;
        TESSERA_TRY(read_attribute(file_, attributes, "TRANSLATION", translations, 3, 0.0f));
        TESSERA_TRY(read_attribute(file_, attributes, "ROTATION", rotations, 4, 0.0f));
        TESSERA_TRY(read_attribute(file_, attributes, "SCALE", scales, 3, 1.0f));
        const std::size_t count = std::max({translations.size(), rotations.size(), scales.size()});
        for (const std::size_t size : {translations.size(), rotations.size(), scales.size()})
            if (size != 0 && size != count)
                return invalid_gltf("EXT_mesh_gpu_instancing has attributes of different lengths");
        for (std::size_t i = 0; i < count; ++i) {
            if (++nodes_ > most_nodes)
                return invalid_gltf("more than " + std::to_string(most_nodes) + " instances");
            tinygltf::Node one;
            const auto take = [i](const auto& from, std::vector<double>& to) {
                if (!from.empty())
                    to.assign(glm::value_ptr(from[i]), glm::value_ptr(from[i]) + from[i].length());
            };
            take(translations, one.translation);
            take(rotations, one.rotation);
            take(scales, one.scale);
            one.weights = node.weights;
            TESSERA_TRY(add_mesh(mesh, place * transform_of(one), one));
        }
        return {};
    }

    // The mesh as the node poses it. Of its transform counts `place` alone.
    Status add_mesh(std::size_t number, const glm::dmat4& place, const tinygltf::Node& node) {
        const tinygltf::Mesh& mesh = file_.meshes[number];
        const bool has_skin = node.skin >= 0;
        // Exporters hide nodes by a scale of 0, or of almost 0.
        if (!has_skin && !(std::abs(glm::determinant(glm::dmat3(place))) > 1e-27)) {
            ++hidden_;
            return {};
        }
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            const int mode = mesh.primitives[i].mode;
            if (mode >= 0 && mode < TINYGLTF_MODE_TRIANGLES) { // no surface
                ++skipped_;
                continue;
            }
            TESSERA_TRY_ASSIGN(ModelPart part,
                               read_primitive(file_, safe_, sets_, number, i, has_skin));
            TESSERA_TRY(add_targets(file_, mesh.primitives[i],
                                    node.weights.empty() ? mesh.weights : node.weights, part)
                            .with_context(part.name));
            const bool is_skinned = has_skin && !part.skin.empty();
            if (is_skinned)
                TESSERA_TRY(skins_.apply(node.skin, part));
            TESSERA_TRY(builder_.add(part, is_skinned ? glm::dmat4(1.0) : place));
        }
        return {};
    }

    void note_skipped() {
        std::vector<std::string>& notes = builder_.model().notes;
        if (hidden_ > 0)
            notes.push_back("skipped " + std::to_string(hidden_) +
                            (hidden_ == 1 ? " mesh" : " meshes") + " with a scale of 0");
        if (dark_ > 0)
            notes.push_back("skipped " + std::to_string(dark_) +
                            (dark_ == 1 ? " light" : " lights") + " without any intensity");
        if (skipped_ > 0)
            notes.push_back("skipped " + std::to_string(skipped_) +
                            (skipped_ == 1 ? " primitive" : " primitives") +
                            " of points or lines, which have no surface");
    }

    const tinygltf::Model& file_;
    const SafeGltf& safe_;
    const std::vector<UvSets>& sets_;
    ModelBuilder& builder_;
    GltfSkins skins_;
    GltfCameras cameras_;
    std::size_t nodes_ = 0;
    std::size_t hidden_ = 0;  // meshes of scale 0
    std::size_t dark_ = 0;    // lights without intensity
    std::size_t skipped_ = 0; // primitives of points or lines
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
    return invalid_gltf("cannot be read: " +
                        (text.empty() ? "tinygltf states no reason" : text.substr(0, 300)));
}

// Gives each view that meshoptimizer compressed a buffer of its own.
Status decompress(const SafeGltf& safe, tinygltf::Model& file) {
    std::size_t total = 0;
    for (const auto& [number, use] : safe.meshopt) {
        const std::string who = "bufferView " + std::to_string(number);
        total += use.count * use.stride;
        if (total > most_model_bytes)
            return {ErrorCode::unsupported, who + ": the views decode to more than 2 GB"};
        TESSERA_TRY_ASSIGN(const auto stream, view_bytes(file, static_cast<int>(number), who));
        tinygltf::Buffer buffer;
        TESSERA_TRY_ASSIGN(buffer.data, decode_meshopt(stream, use).with_context(who));
        tinygltf::BufferView& view = file.bufferViews[number];
        view.buffer = static_cast<int>(file.buffers.size());
        view.byteOffset = 0;
        view.byteLength = buffer.data.size();
        if (use.mode == "ATTRIBUTES")
            view.byteStride = use.stride;
        file.buffers.push_back(std::move(buffer));
    }
    return {};
}

// Says what the file has and Tessera does not model, one line per feature.
void note_ignored(const tinygltf::Model& file, const SafeGltf& safe,
                  std::vector<std::string>& notes) {
    const auto note = [&](std::size_t count, const std::string& one, const std::string& many,
                          const std::string& what) {
        if (count > 0)
            notes.push_back(std::to_string(count) + " " + (count == 1 ? one : many) + " " + what);
    };
    for (const auto& [name, uses] : safe.ignored)
        notes.push_back("the extension " + name + " (" + std::to_string(uses) +
                        (uses == 1 ? " use" : " uses") + ") is not supported and is ignored");
    note(file.animations.size(), "animation", "animations", "not played");
}

Status convert(const tinygltf::Model& file, const SafeGltf& safe, const std::string& folder,
               ModelBuilder& builder) {
    TESSERA_TRY_ASSIGN(const std::vector<UvSets> sets,
                       read_materials(file, folder, builder.model()));
    note_ignored(file, safe, builder.model().notes);
    return GltfScene(file, safe, sets, builder).add();
}

} // namespace

Status read_gltf(const std::string& path, ModelBuilder& builder) {
    TESSERA_TRY_ASSIGN(auto bytes, read_whole_file(path, most_model_bytes));
    TESSERA_TRY(check_is_model(bytes));
    TESSERA_TRY_ASSIGN(const SafeGltf safe, make_safe_gltf(std::move(bytes)));
    tinygltf::Model file;
    TESSERA_TRY(load(path, safe, file));
    TESSERA_TRY(decompress(safe, file));
    return convert(file, safe, folder_of(path), builder);
}

} // namespace tessera::corpus
