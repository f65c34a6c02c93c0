// One tile's payload -> its texels, in stages: streams, levels, planes, samples, corrections.
#pragma once

#include "codec/entropy/context_grid.h"
#include "codec/entropy/corrections.h"
#include "codec/reconstruct/reconstruct.h"
#include "codec/reconstruct/tile_filter.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"

#include <cstddef>
#include <span>

namespace tessera {

// Decodes tiles of one file. Holds scratch memory: one per thread.
class TileDecoder {
public:
    // Both outlive the decoder.
    TileDecoder(const TileCoding& coding, const ColourCoding& colour)
        : coding_(&coding), colour_(&colour) {}

    // texels: dense box order, exactly the tile's bytes. Errors: invalid_file. On any payload it
    // ends, stays in bounds, and either fails or fills `texels`.
    Status decode(std::span<const std::byte> payload, const BlockShape& shape,
                  std::span<std::byte> texels);
    // The same from levels and corrections that are at hand.
    void render(const TileLevels& levels, const CorrectionMap& corrections,
                std::span<std::byte> texels);
    // Only the entropy decoding; the results stay valid until the next call.
    Status parse(std::span<const std::byte> payload, const BlockShape& shape);
    const TileLevels& levels() const { return levels_; }
    const CorrectionMap& corrections() const { return corrections_; }
    // Whether the last payload was a stored tile: it has no levels and no corrections.
    bool is_stored() const { return is_stored_; }
    // Of the last decode() or render(), filtered.
    const TilePlanes& planes() const { return planes_; }

private:
    const TileCoding* coding_;
    const ColourCoding* colour_;
    PayloadParts parts_;
    ContextGrid grid_;
    TileLevels levels_;
    CorrectionMap corrections_;
    bool is_stored_ = false;
    ReconstructScratch scratch_;
    FilterScratch filter_scratch_;
    TilePlanes planes_;
};

BlockShape tile_shape(const Box4& box);

// The samples of a stored tile as they decode (FORMAT.md 3.2): those that have a code as they are, but -0
// as 0.
void copy_stored(std::span<const std::byte> samples, SampleType type, std::span<std::byte> texels);

} // namespace tessera
