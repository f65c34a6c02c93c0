// Bakes the original texture of a compressed file again, texel by texel as it is read.
#pragma once

#include "corpus/scene.h"
#include "format/metadata.h"
#include "format/texture.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace tessera {

constexpr unsigned usual_samples = 16; // rays per texel, the default of `tessera bake`

// How to bake. Absent values are taken from the file's metadata, or else are the defaults.
struct BakeAgain {
    std::string scene;
    std::optional<unsigned> samples; // rays per texel
    std::optional<std::uint64_t> seed;
};

// `size`, `description` and `metadata` are those of the file `name`. The sample type and the number
// of channels are the scene's and may differ from the file's. Errors: bad_argument (no such scene,
// or the file states too many samples per texel), unsupported (the texture lies on a mesh).
Result<std::unique_ptr<TexelSource>> bake_again(const BakeAgain& bake, const std::string& name,
                                                const Extent4& size, const Description& description,
                                                const Metadata& metadata);

// The sphere on which the texels are baked. A sphere that is seen from inside has the description's
// centre and radius; otherwise it is the scene's own sphere.
corpus::SphereWindow baked_window(const Description& description);

} // namespace tessera
