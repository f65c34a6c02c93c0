#include "corpus/model/gltf_json.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

namespace tessera::corpus {
namespace {

using Json = nlohmann::json;

constexpr int deepest_json = 64;
constexpr std::size_t longest_header = 300; // of a data URI
constexpr const char* draco_name = "KHR_draco_mesh_compression";
constexpr const char* meshopt_name = "EXT_meshopt_compression";

std::uint32_t number_at(const std::vector<unsigned char>& bytes, std::size_t at) {
    std::uint32_t x = 0;
    for (std::size_t i = 0; i < 4; ++i)
        x |= std::uint32_t{bytes[at + i]} << (8 * i);
    return x;
}

Status other_version(const std::string& version) {
    return {ErrorCode::unsupported,
            "is glTF " + version + "; only glTF 2.0 is read. Export it again as glTF 2.0"};
}

struct Chunks {
    std::string json;
    std::vector<unsigned char> binary;
};

Result<Chunks> split(std::vector<unsigned char> bytes) {
    Chunks chunks;
    if (bytes.size() < 4 || std::memcmp(bytes.data(), "glTF", 4) != 0) {
        chunks.json.assign(bytes.begin(), bytes.end());
        return chunks;
    }
    if (bytes.size() < 20)
        return invalid_gltf("the .glb is cut short");
    if (number_at(bytes, 4) != 2)
        return other_version(std::to_string(number_at(bytes, 4)));
    std::size_t at = 12;
    for (int i = 0; at + 8 <= bytes.size(); ++i) {
        const std::size_t length = number_at(bytes, at);
        const std::uint32_t kind = number_at(bytes, at + 4);
        at += 8;
        if (length > bytes.size() - at)
            return invalid_gltf("chunk " + std::to_string(i) + " of the .glb states " +
                                std::to_string(length) + " bytes, but only " +
                                std::to_string(bytes.size() - at) + " are left");
        const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        const auto end = begin + static_cast<std::ptrdiff_t>(length);
        if (i == 0 && kind == 0x4E4F534A)
            chunks.json.assign(begin, end);
        else if (i == 1 && kind == 0x004E4942)
            chunks.binary.assign(begin, end);
        at += length;
    }
    return chunks;
}

// The elements of the array, which must be objects. A missing array has none.
Result<std::vector<Json*>> objects_of(Json& parent, const char* name) {
    std::vector<Json*> all;
    const auto it = parent.find(name);
    if (it == parent.end())
        return all;
    if (!it->is_array())
        return invalid_gltf(std::string(name) + " is not an array");
    for (Json& element : *it) {
        if (!element.is_object())
            return invalid_gltf(std::string(name) + " " + std::to_string(all.size()) +
                                " is not an object");
        all.push_back(&element);
    }
    return all;
}

// A count or an index; `absent` if it is missing, -1 if it is not one.
std::int64_t count_of(const Json& object, const char* name, std::int64_t absent) {
    const auto it = object.find(name);
    if (it == object.end())
        return absent;
    if (!it->is_number_integer())
        return -1;
    const auto x = it->get<std::int64_t>();
    return x >= 0 && x <= INT32_MAX ? x : -1;
}

Status check_views(Json& root) {
    TESSERA_TRY_ASSIGN(const auto buffers, objects_of(root, "buffers"));
    TESSERA_TRY_ASSIGN(const auto views, objects_of(root, "bufferViews"));
    for (std::size_t i = 0; i < views.size(); ++i) {
        const std::int64_t buffer = count_of(*views[i], "buffer", -1);
        const std::int64_t offset = count_of(*views[i], "byteOffset", 0);
        const std::int64_t length = count_of(*views[i], "byteLength", -1);
        const std::string name = "bufferView " + std::to_string(i);
        if (buffer < 0 || static_cast<std::size_t>(buffer) >= buffers.size())
            return invalid_gltf(name + " has no buffer");
        const std::int64_t size =
            count_of(*buffers[static_cast<std::size_t>(buffer)], "byteLength", -1);
        if (offset < 0 || length < 0 || size < 0 || offset + length > size)
            return invalid_gltf(name + " lies outside its buffer");
    }
    TESSERA_TRY_ASSIGN(const auto images, objects_of(root, "images"));
    for (std::size_t i = 0; i < images.size(); ++i) {
        const std::int64_t view = count_of(*images[i], "bufferView", 0);
        if (view < 0 ||
            (images[i]->contains("bufferView") && static_cast<std::size_t>(view) >= views.size()))
            return invalid_gltf("image " + std::to_string(i) + " has no bufferView");
    }
    return {};
}

// Makes a compressed view refer to its compressed bytes, which tinygltf can load.
Result<MeshoptUse> take_meshopt(Json& view, const std::string& name) {
    const Json extension = view["extensions"][meshopt_name];
    view["extensions"].erase(meshopt_name);
    const auto text = [&](const char* key) {
        const auto it = extension.find(key);
        return it != extension.end() && it->is_string() ? it->get<std::string>() : std::string();
    };
    if (!extension.is_object())
        return invalid_gltf(name + ": " + meshopt_name + " is not an object");
    MeshoptUse use;
    use.mode = text("mode");
    use.filter = text("filter");
    const std::int64_t stride = count_of(extension, "byteStride", -1);
    const std::int64_t count = count_of(extension, "count", -1);
    for (const char* key : {"buffer", "byteLength"})
        if (count_of(extension, key, -1) < 0)
            return invalid_gltf(name + ": " + meshopt_name + " has no " + key);
    if (stride <= 0 || stride > 256 || count < 0 || count > most_vertices * 6)
        return invalid_gltf(name + ": " + meshopt_name + " has " + std::to_string(count) +
                            " elements of " + std::to_string(stride) + " bytes");
    use.stride = static_cast<std::size_t>(stride);
    use.count = static_cast<std::size_t>(count);
    view["buffer"] = extension["buffer"];
    view["byteOffset"] = count_of(extension, "byteOffset", 0);
    view["byteLength"] = extension["byteLength"];
    return use;
}

// Takes the extension from all views. Buffers that only stand in for decoded bytes have none.
Status take_all_meshopt(Json& root, bool has_binary, SafeGltf& safe) {
    TESSERA_TRY_ASSIGN(const auto views, objects_of(root, "bufferViews"));
    for (std::size_t i = 0; i < views.size(); ++i) {
        const auto extensions = views[i]->find("extensions");
        if (extensions == views[i]->end() || !extensions->is_object() ||
            !extensions->contains(meshopt_name))
            continue;
        TESSERA_TRY_ASSIGN(safe.meshopt[i],
                           take_meshopt(*views[i], "bufferView " + std::to_string(i)));
    }
    if (safe.meshopt.empty())
        return {};
    TESSERA_TRY_ASSIGN(const auto buffers, objects_of(root, "buffers"));
    for (std::size_t i = has_binary ? 1 : 0; i < buffers.size(); ++i)
        if (!buffers[i]->contains("uri")) {
            (*buffers[i])["uri"] = "data:application/octet-stream;base64,AA==";
            (*buffers[i])["byteLength"] = 1;
        }
    return {};
}

Result<DracoUse> take_draco(Json& primitive, const std::string& name) {
    DracoUse use;
    const Json extension = primitive["extensions"][draco_name];
    primitive["extensions"].erase(draco_name);
    primitive.erase("indices"); // the accessor has no bytes; the indices are in the stream
    if (!extension.is_object())
        return invalid_gltf(name + ": " + draco_name + " is not an object");
    use.view = static_cast<int>(count_of(extension, "bufferView", -1));
    const auto attributes = extension.find("attributes");
    if (use.view < 0 || attributes == extension.end() || !attributes->is_object())
        return invalid_gltf(name + ": " + draco_name + " lacks a bufferView or attributes");
    for (const auto& [key, value] : attributes->items()) {
        if (!value.is_number_integer())
            return invalid_gltf(name + ": Draco attribute " + key + " is not a number");
        use.attributes[key] = static_cast<int>(count_of(*attributes, key.c_str(), -1));
    }
    return use;
}

// glTF 2.x is read unless it needs a later version than 2.0.
Status check_version(const Json& root) {
    const auto asset = root.find("asset");
    for (const char* key : {"version", "minVersion"}) {
        if (asset == root.end() || !asset->is_object() || !asset->contains(key) ||
            !(*asset)[key].is_string())
            continue;
        const auto version = (*asset)[key].get<std::string>().substr(0, longest_shown);
        if (version != "2.0" && (key == std::string("minVersion") || !version.starts_with("2.")))
            return other_version(version);
    }
    // Early files state no version, but have objects in place of arrays.
    for (const char* key : {"accessors", "meshes", "nodes"})
        if (const auto it = root.find(key); it != root.end() && it->is_object())
            return other_version("1.0");
    return {};
}

bool is_supported(const std::string& extension) {
    constexpr const char* supported[] = {draco_name,
                                         "EXT_mesh_gpu_instancing",
                                         "EXT_texture_webp",
                                         meshopt_name,
                                         "KHR_lights_punctual",
                                         "KHR_materials_anisotropy",
                                         "KHR_materials_clearcoat",
                                         "KHR_materials_emissive_strength",
                                         "KHR_materials_ior",
                                         "KHR_materials_iridescence",
                                         "KHR_materials_pbrSpecularGlossiness",
                                         "KHR_materials_sheen",
                                         "KHR_materials_specular",
                                         "KHR_materials_transmission",
                                         "KHR_materials_unlit",
                                         "KHR_materials_volume",
                                         "KHR_mesh_quantization",
                                         "KHR_texture_basisu",
                                         "KHR_texture_transform"};
    return std::ranges::find(supported, extension) != std::end(supported);
}

Status check_extensions(const Json& root) {
    const auto it = root.find("extensionsRequired");
    if (it == root.end() || !it->is_array())
        return {};
    for (const Json& name : *it)
        if (!name.is_string() || !is_supported(name.get<std::string>()))
            return {ErrorCode::unsupported,
                    "requires the extension " + name.dump().substr(0, longest_shown)};
    return {};
}

// Counts the uses of unsupported extensions below `value`, which is at most deepest_json deep.
void count_ignored(const Json& value, std::map<std::string, std::size_t>& ignored) {
    if (value.is_object())
        if (const auto it = value.find("extensions"); it != value.end() && it->is_object())
            for (const auto& [name, extension] : it->items())
                if (!is_supported(name))
                    ++ignored[name.substr(0, longest_shown)];
    for (const Json& part : value)
        if (part.is_structured())
            count_ignored(part, ignored);
}

// Makes tinygltf find what a URI means: it takes '+' for a blank, and knows few media types of data.
void normalise_uri(Json& object) {
    const auto it = object.find("uri");
    if (it == object.end() || !it->is_string())
        return;
    auto uri = it->get<std::string>();
    const auto lower = [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    };
    const std::size_t comma = std::min(uri.find(','), longest_header);
    std::string header = uri.substr(0, comma);
    std::ranges::transform(header, header.begin(), lower);
    if (!header.starts_with("data:")) {
        for (std::size_t i = 0; (i = uri.find('+', i)) != std::string::npos; i += 3)
            uri.replace(i, 1, "%2B");
    } else if (header.ends_with(";base64")) {
        uri.replace(0, comma, "data:application/octet-stream;base64");
    }
    *it = std::move(uri);
}

} // namespace

Result<SafeGltf> make_safe_gltf(std::vector<unsigned char> bytes) {
    TESSERA_TRY_ASSIGN(Chunks chunks, split(std::move(bytes)));
    SafeGltf safe;
    safe.binary = std::move(chunks.binary);
    bool too_deep = false;
    const auto watch = [&](int depth, Json::parse_event_t, Json&) {
        too_deep = too_deep || depth > deepest_json;
        return !too_deep;
    };
    Json root = Json::parse(chunks.json, watch, false);
    if (too_deep)
        return invalid_gltf("the JSON is nested more than " + std::to_string(deepest_json) +
                            " deep");
    if (!root.is_object())
        return invalid_gltf("is not JSON");
    TESSERA_TRY(check_version(root));
    TESSERA_TRY(check_extensions(root));
    count_ignored(root, safe.ignored);
    TESSERA_TRY(take_all_meshopt(root, !safe.binary.empty(), safe));
    TESSERA_TRY(check_views(root));
    for (const char* name : {"buffers", "images"}) {
        TESSERA_TRY_ASSIGN(const auto objects, objects_of(root, name));
        for (Json* object : objects)
            normalise_uri(*object);
    }
    TESSERA_TRY_ASSIGN(const auto meshes, objects_of(root, "meshes"));
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        TESSERA_TRY_ASSIGN(const auto primitives, objects_of(*meshes[m], "primitives"));
        for (std::size_t p = 0; p < primitives.size(); ++p) {
            Json& primitive = *primitives[p];
            const auto extensions = primitive.find("extensions");
            if (extensions == primitive.end() || !extensions->is_object() ||
                !extensions->contains(draco_name))
                continue;
            const std::string name =
                "mesh " + std::to_string(m) + ", primitive " + std::to_string(p);
            TESSERA_TRY_ASSIGN(DracoUse use, take_draco(primitive, name));
            safe.draco.emplace(std::pair(m, p), std::move(use));
        }
    }
    safe.json = root.dump(-1, ' ', false, Json::error_handler_t::replace);
    return safe;
}

} // namespace tessera::corpus
