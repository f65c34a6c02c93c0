// Checks the JSON of a glTF file before tinygltf reads it, because tinygltf trusts some numbers in
// it.
#pragma once

#include "format/status.h"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tessera::corpus {

constexpr std::uint32_t most_vertices = 1u << 23; // per primitive
constexpr std::size_t longest_shown = 80;         // of a name in the file, in messages

inline Status invalid_gltf(const std::string& text) {
    return {ErrorCode::invalid_file, text};
}

// The Draco stream of a primitive.
struct DracoUse {
    int view = -1;
    std::map<std::string, int> attributes; // from glTF's name to Draco's unique id
};

// A view whose bytes meshoptimizer compressed.
struct MeshoptUse {
    std::string mode, filter;
    std::size_t stride = 0, count = 0; // bytes of an element, elements
};

struct SafeGltf {
    std::string json;                  // without the Draco extension
    std::vector<unsigned char> binary; // the buffer of a .glb; may be empty
    std::map<std::pair<std::size_t, std::size_t>, DracoUse> draco; // by mesh and primitive
    std::map<std::size_t, MeshoptUse> meshopt;                     // by view
    std::map<std::string, std::size_t> ignored; // how often unsupported extensions are used
};

// Checks the bytes of a .gltf or .glb. Errors: invalid_file (no JSON, nested too deeply, a view
// outside its buffer, wrong numbers); unsupported (a required extension).
Result<SafeGltf> make_safe_gltf(std::vector<unsigned char> bytes);

} // namespace tessera::corpus
