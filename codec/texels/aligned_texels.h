// A texture as its aligned views lie in the grid of tiles, for the encoder.
#pragma once

#include "format/levels.h"
#include "format/status.h"
#include "format/texture.h"

#include <memory>

namespace tessera {

// `source` itself where its boxes can be read in any order, else nothing but what was read of it into `held`, all
// of it. Errors: those of `source`; over_budget (a slab of it is above slab_bytes).
Result<TexelSource*> in_any_order(TexelSource& source, unsigned threads, std::uint64_t slab_bytes,
                                  std::unique_ptr<TexelSource>& held);

class AlignedTexels {
public:
    // `source`, of Locality::any, and `matters`, a mask of it or nullptr, outlive what comes back.
    static std::unique_ptr<AlignedTexels> make(TexelSource& source, const AlignedViews& views,
                                               TexelSource* matters);
    virtual ~AlignedTexels() = default;

    // Of the grid's size, in boxes of any order. Where no view is, the nearest texel of the view: a start that
    // has no edge of its own.
    virtual TexelSource& texels() = 0;
    // Which of them matter, of those that the texture has, as EncodeOptions::mask says it.
    virtual TexelSource& mask() = 0;
};

} // namespace tessera
