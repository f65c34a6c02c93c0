// The JSON and the binary chunk of a .glb that is being made.
#pragma once

#include "format/byte_source.h"
#include "tools/gltf/meshopt_primitive.h"
#include "tools/support/json_text.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera {

class GlbFile {
public:
    GlbFile();

    // What a buffer view holds besides pictures and streams: numbers of glTF 2.0.
    static constexpr int no_target = 0, vertices = 34962, indices = 34963;

    // Each returns the index of what it adds.
    std::size_t add_view(std::span<const std::byte> bytes, int target = no_target);
    std::size_t add_meshopt_view(const MeshoptView& view, int target);
    std::size_t add_accessor(Json accessor);
    std::size_t add_material(Json material);
    // `texture` gets the extension that names the .tess file, which must outlive this object.
    std::size_t add_texture(Json texture, ByteSource& tess);
    // Names an extension that the file uses, once. required: readers must know it.
    void use_extension(const char* name, bool required);

    // The bytes of all views but those of .tess files.
    std::uint64_t chunk_bytes() const { return chunk_.size(); }

    // Writes everything, with the .tess files at the end. Returns the size of the file in bytes.
    // Errors: unsupported (4 GiB or more); those of reading the .tess files; io.
    Result<std::uint64_t> write(const std::string& output);

    Json json; // all but the views, accessors and buffers

private:
    std::size_t append(std::span<const std::byte> bytes); // returns their offset

    Json views_ = Json::array(), accessors_ = Json::array();
    std::vector<std::byte> chunk_;
    std::uint64_t unpacked_bytes_ = 0; // of what meshoptimizer has compressed
    std::vector<ByteSource*> files_;   // by the index of the texture
};

} // namespace tessera
