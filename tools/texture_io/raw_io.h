// Raw texels: nothing but samples, in the order v, u, t, s with s fastest and the channels of a
// texel adjacent, one byte or one little-endian half each. Geometry comes from elsewhere.
#pragma once

#include "format/texture.h"

#include <memory>
#include <string>

namespace tessera {

// Any box, by reads at offsets, from any thread. Errors: io; invalid_file where the file's size is
// not exactly that of `desc`.
Result<std::unique_ptr<TexelSource>> open_raw(const std::string& path, const TextureDesc& desc);

// Appears as `path` after finish(). Errors: io.
Result<std::unique_ptr<TexelSink>> create_raw(const std::string& path, const TextureDesc& desc);

} // namespace tessera
