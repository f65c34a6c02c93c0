// Reads the objects of extensions. Values of another type than the specification's count as missing.
#pragma once

#include "corpus/model/gltf_accessors.h"
#include "corpus/model/model.h"

namespace tessera::corpus {

inline double number_or(const tinygltf::Value& object, const char* key, double otherwise) {
    return object.Has(key) && object.Get(key).IsNumber() ? object.Get(key).GetNumberAsDouble()
                                                         : otherwise;
}

inline glm::dvec2 pair_or(const tinygltf::Value& object, const char* key,
                          const glm::dvec2& otherwise) {
    if (!object.Has(key) || !object.Get(key).IsArray() || object.Get(key).ArrayLen() != 2)
        return otherwise;
    const tinygltf::Value &x = object.Get(key).Get(0), &y = object.Get(key).Get(1);
    return x.IsNumber() && y.IsNumber() ? glm::dvec2(x.GetNumberAsDouble(), y.GetNumberAsDouble())
                                        : otherwise;
}

// The object of an extension, or null.
inline const tinygltf::Value* extension_of(const tinygltf::ExtensionMap& extensions,
                                           const char* name) {
    const auto it = extensions.find(name);
    return it != extensions.end() && it->second.IsObject() ? &it->second : nullptr;
}

inline double listed_number(const tinygltf::Value& list, std::size_t index, double otherwise) {
    const tinygltf::Value& number = list.Get(static_cast<int>(index));
    return number.IsNumber() ? number.GetNumberAsDouble() : otherwise;
}

// Three numbers from 0 to 10,000.
inline glm::dvec3 colour_or(const tinygltf::Value& object, const char* key,
                            const glm::dvec3& otherwise) {
    if (!object.Has(key) || !object.Get(key).IsArray() || object.Get(key).ArrayLen() < 3)
        return otherwise;
    glm::dvec3 colour;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto channel = static_cast<glm::length_t>(c);
        colour[channel] = listed_number(object.Get(key), c, otherwise[channel]);
    }
    return glm::clamp(colour, 0.0, 1e4);
}

// The texture that an extension names under `key`; none without it.
Result<TextureUse> extension_texture(const tinygltf::Model& file, const tinygltf::Value& extension,
                                     const char* key, const std::string& who,
                                     std::vector<std::string>& notes);

} // namespace tessera::corpus
