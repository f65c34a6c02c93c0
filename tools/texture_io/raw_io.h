// Raw texels: nothing but samples, in the order v, u, t, s with s fastest and the channels of a
// texel adjacent, one byte or one little-endian half each. Geometry comes from elsewhere.
#pragma once

#include "format/byte_source.h"
#include "format/texture.h"

#include <memory>
#include <string>

namespace tessera {

// Any box, by reads at offsets, from any thread. Errors: io; invalid_file where the file's size is
// not exactly that of `desc`.
Result<std::unique_ptr<TexelSource>> open_raw(std::unique_ptr<ByteSource> file,
                                              const TextureDesc& desc);
Result<std::unique_ptr<TexelSource>> open_raw(const std::string& path, const TextureDesc& desc);

// Appears as `path` after finish(). Errors: io.
Result<std::unique_ptr<TexelSink>> create_raw(const std::string& path, const TextureDesc& desc);

// Rows of v as they come; what was written stays where the rest fails. Errors: io.
Result<std::unique_ptr<TexelSink>> raw_to_standard_output(const TextureDesc& desc);

} // namespace tessera
