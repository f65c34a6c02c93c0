// The pictures of glTF files.
#pragma once

#include "corpus/model/readers.h"

#include <tiny_gltf.h>

namespace tessera::corpus {

// For messages: "image 3 (leather.png)".
std::string image_name(const tinygltf::Image& image, std::size_t number);

// Decodes image `number`, whose encoded bytes tinygltf has loaded. In place of a KTX2 file it takes a
// PNG, JPEG or WebP of the same name beside it, and notes that; `folder` is that of the glTF file.
// Errors name the image: io (missing); those of decode_image().
Result<Image> read_image(const tinygltf::Image& image, std::size_t number,
                         const std::string& folder, std::vector<std::string>& notes);

} // namespace tessera::corpus
