// The baker: a source of texels that ray traces the boxes of a scene that it is asked to read.
#pragma once

#include "corpus/catalog.h"
#include "format/texture.h"

#include <cstdint>
#include <memory>
#include <string>

namespace tessera::corpus {

constexpr unsigned max_samples_per_texel = 65536;

// A texture of the built-in scene `name` on the sphere `window`: RGB, of the scene's sample type.
//
// A texel is the mean of `samples_per_texel` (1..65536) rays that spread over the texel along all
// four axes. One sample is the ray through the texel's centre. The bytes depend on the arguments
// only, not on the boxes that are read, their order or the number of threads. read() is thread-safe
// and needs memory for a few rows of the box; a box outside the texture or an `out` of the wrong
// size is bad_argument.
//
// Errors: bad_argument (unknown scene, size that check_desc() refuses, wrong number of samples, a
// painted scene seen from inside); runtime (out of memory).
Result<std::unique_ptr<TexelSource>> make_baked_source(const std::string& name, const Extent4& size,
                                                       unsigned samples_per_texel,
                                                       std::uint64_t seed,
                                                       const SphereWindow& window = {});

} // namespace tessera::corpus
