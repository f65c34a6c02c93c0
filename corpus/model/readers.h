// The readers behind load_model(). Their errors name the element; load_model() adds the file.
#pragma once

#include "corpus/model/gltf_attributes.h"
#include "corpus/model/gltf_json.h"
#include "corpus/model/model_builder.h"

#include <span>

namespace tessera::corpus {

constexpr std::size_t most_model_bytes = std::size_t{1} << 31; // per file

Status read_gltf(const std::string& path, ModelBuilder& builder); // .gltf, .glb
Status read_obj(const std::string& path, ModelBuilder& builder);
Status read_ply(const std::string& path, ModelBuilder& builder);
Status read_stl(const std::string& path, ModelBuilder& builder);

// Decodes a glTF primitive that is a Draco stream into `part`. Errors: invalid_file; unsupported
// (too large).
Status decode_draco_part(std::span<const unsigned char> stream, const DracoUse& use,
                         const Attributes& attributes, ModelPart& part);

// Decodes a glTF view that meshoptimizer compressed. Errors: invalid_file.
Result<std::vector<unsigned char>> decode_meshopt(std::span<const unsigned char> stream,
                                                  const MeshoptUse& use);

// The folder of the file; "." if the path has none.
std::string folder_of(const std::string& path);

// A whole file of at most `most` bytes. Errors: io, naming it; unsupported (larger).
Result<std::vector<unsigned char>> read_whole_file(const std::string& path, std::size_t most);

// Refuses the content of a file that is of another known kind. Error: invalid_file, which names it.
Status check_is_model(const std::vector<unsigned char>& bytes);

} // namespace tessera::corpus
