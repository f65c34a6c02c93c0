// The texture that a compressed file was made from, baked again where it is read.
#pragma once

#include "corpus/scene.h"
#include "format/metadata.h"
#include "format/texture.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace tessera {

constexpr unsigned usual_samples = 16; // per texel, as tessera bake has it

// What is said about the baking; the rest is what the file's metadata remember, or else usual.
struct BakeAgain {
    std::string scene;
    std::optional<unsigned> samples; // per texel
    std::optional<std::uint64_t> seed;
};

// `size`, `description` and `metadata` are those of the file `name`; its samples may be of another type or
// number.
// Errors: bad_argument (no such scene, the file remembers more samples than there can be);
// unsupported (the file's texture lies on a mesh).
Result<std::unique_ptr<TexelSource>> bake_again(const BakeAgain& bake, const std::string& name,
                                                const Extent4& size, const Description& description,
                                                const Metadata& metadata);

// Where the texels of such a description are baked: a sphere that is seen from inside stands in the scene as
// it is said, others are the scene's own.
corpus::SphereWindow baked_window(const Description& description);

} // namespace tessera
