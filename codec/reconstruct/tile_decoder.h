// Decodes a tile's payload to texels in stages: streams, levels, planes, samples, corrections.
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

// Decodes tiles of one file. Holds scratch memory, so each thread needs its own.
class TileDecoder {
public:
    // Both arguments must outlive the decoder.
    TileDecoder(const TileCoding& coding, const ColourCoding& colour)
        : coding_(&coding), colour_(&colour) {}

    // Decodes a payload into `texels`, a dense box of exactly the tile's size. On any payload it
    // terminates, stays in bounds, and either fails or fills `texels`. Errors: invalid_file.
    Status decode(std::span<const std::byte> payload, const BlockShape& shape,
                  std::span<std::byte> texels);
    // The same from given levels and corrections.
    void render(const TileLevels& levels, const CorrectionMap& corrections,
                std::span<std::byte> texels);
    // Entropy decoding only. The results stay valid until the next call.
    Status parse(std::span<const std::byte> payload, const BlockShape& shape);
    const TileLevels& levels() const { return levels_; }
    const CorrectionMap& corrections() const { return corrections_; }
    // Whether the last payload was a stored tile, which has no levels and no corrections.
    bool is_stored() const { return is_stored_; }
    // The filtered planes of the last decode() or render().
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

// Copies the samples of a stored tile as they decode (FORMAT.md 3.2): through their codes, which
// clamps them and turns -0 into 0.
void copy_stored(std::span<const std::byte> samples, SampleType type, std::span<std::byte> texels);

} // namespace tessera
