// A glTF primitive that is a Draco stream.
#pragma once

#include "corpus/model/gltf_json.h"
#include "corpus/model/model_builder.h"

#include <span>

namespace tessera::corpus {

// Fills what the part's attributes say. Errors: invalid_file, unsupported (too large).
Status decode_draco_part(std::span<const unsigned char> stream, const DracoUse& use,
                         ModelPart& part);

} // namespace tessera::corpus
