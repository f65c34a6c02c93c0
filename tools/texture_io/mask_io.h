// --mask: which texels of a texture matter.
#pragma once

#include "format/texture.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

namespace tessera {

struct MaskArguments {
    std::string path, size; // empty path: all texels matter
};

// `meaning`: what the verb does with masked texels.
void add_mask_options(CLI::App& app, MaskArguments& arguments, const std::string& meaning);

// Opens the mask of a texture of `texture_size`, interruptible; nullptr without --mask. Raw files
// of one 8-bit channel are read in place. Others are loaded: their first channel, one byte per
// texel, which is subtracted from `slab_bytes`, the budget for texels in memory. Errors: those of
// open_texture(); bad_argument (it does not fit), over_budget (it takes more than half of
// `slab_bytes`).
Result<std::unique_ptr<TexelSource>> open_mask(const MaskArguments& arguments,
                                               const Extent4& texture_size, unsigned threads,
                                               std::uint64_t& slab_bytes);

} // namespace tessera
