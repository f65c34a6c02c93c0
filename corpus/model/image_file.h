// Pictures of any kind that stb_image reads.
#pragma once

#include "corpus/model/model.h"

#include <cstddef>
#include <span>

namespace tessera::corpus {

// PNG, JPEG and others. Errors: invalid_file; unsupported (too large).
Result<Image> decode_image(std::span<const unsigned char> bytes);

// Linear light, rows from the top.
struct LightImage {
    std::uint32_t width = 0, height = 0;
    std::vector<glm::vec3> texels;
};

// Radiance's .hdr. Errors as above.
Result<LightImage> decode_hdr(std::span<const unsigned char> bytes);

// A whole file of at most `most` bytes. Errors: io, naming it; unsupported (larger).
Result<std::vector<unsigned char>> read_whole_file(const std::string& path, std::size_t most);

} // namespace tessera::corpus
