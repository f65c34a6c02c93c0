// A glTF file's JSON, made safe for tinygltf, which trusts some numbers in it.
#pragma once

#include "format/status.h"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tessera::corpus {

constexpr std::uint32_t most_vertices = 1u << 23; // of a primitive

inline Status invalid_gltf(const std::string& text) {
    return {ErrorCode::invalid_file, text};
}

// A primitive's Draco stream.
struct DracoUse {
    int view = -1;
    std::map<std::string, int> attributes; // glTF's name to Draco's unique id
};

struct SafeGltf {
    std::string json;                  // without what DracoUse has
    std::vector<unsigned char> binary; // of a .glb: its buffer; may be empty
    std::map<std::pair<std::size_t, std::size_t>, DracoUse> draco; // by mesh and primitive
};

// Of a .gltf's or .glb's bytes. Errors: invalid_file (no JSON, nested too deeply, a view outside of
// its buffer, numbers that are none), unsupported (an extension that the file requires).
Result<SafeGltf> make_safe_gltf(std::vector<unsigned char> bytes);

} // namespace tessera::corpus
