// The baker: a scene as a source of texels, ray traced box by box as they are asked for.
#pragma once

#include "corpus/catalog.h"
#include "format/texture.h"

#include <cstdint>
#include <memory>
#include <string>

namespace tessera::corpus {

constexpr unsigned max_samples_per_texel = 65536;

// Texels of the scene `name`: 3 channels RGB, unorm8 or half16 as find_scene(name) says.
//
// A texel is the mean of `samples_per_texel` (1..65536) rays spread over all four dimensions of the
// texel; with one sample it is the ray of the texel's centre. The bytes depend on the arguments
// only: any partition into boxes, order and number of threads gives the same. read() is thread-safe
// and holds no more than a few rows of the box. A box outside the texture, or an `out` of the wrong
// size, is bad_argument.
//
// `window`: where the texture lies. bad_argument for an unknown scene, a size that check_desc refuses, or a wrong sample count.
Result<std::unique_ptr<TexelSource>> make_baked_source(const std::string& name, const Extent4& size,
                                                       unsigned samples_per_texel,
                                                       std::uint64_t seed,
                                                       const SphereWindow& window = {});

} // namespace tessera::corpus
