// Raw texels: samples only, in the order v, u, t, s with s fastest and the channels of a texel
// adjacent, one byte or one little-endian half each. The file has no header.
#pragma once

#include "format/byte_source.h"
#include "format/texture.h"

#include <memory>
#include <string>

namespace tessera {

// Reads any box at any time, thread-safe. Errors: io; invalid_file where the size of the file is
// not exactly that of `desc`.
Result<std::unique_ptr<TexelSource>> open_raw(std::unique_ptr<ByteSource> file,
                                              const TextureDesc& desc);

// Appears as `path` after finish(). Errors: io.
Result<std::unique_ptr<TexelSink>> create_raw(const std::string& path, const TextureDesc& desc);

// Writes rows of v as they arrive. After an error, what was written stays. Errors: io.
Result<std::unique_ptr<TexelSink>> raw_to_standard_output(const TextureDesc& desc);

} // namespace tessera
