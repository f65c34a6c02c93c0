// An encode up to the pass that meets the rate: everything but the file.
#pragma once

#include "codec/encode/coarse_levels.h"
#include "codec/encode/rate_control.h"

#include <memory>
#include <vector>

namespace tessera {

struct TextureEncode {
    // Only if views are aligned: texels that had to be held, texels and mask in the grid.
    std::unique_ptr<TexelSource> held = nullptr, texels = nullptr, mask = nullptr;
    bool looks_transposed = false;
    EncodePlan plan; // refers to the above
    RateOutcome outcome = {};
    std::vector<CoarseLevel> levels = {}; // of pass number `levels_of`
    unsigned levels_of = 0;

    // Sets `levels` to those of a pass, unless they are already.
    Status make_levels(const PassResult& pass);
    // The size of the file that a pass makes.
    Result<std::uint64_t> file_bytes(const PassResult& pass);
};

// `source` and `options` outlive the result. `journal` may be nullptr. Errors: those of encode_file.
Result<std::unique_ptr<TextureEncode>> encode_to_rate(TexelSource& source,
                                                      const EncodeOptions& options,
                                                      const ToolSwitches& tools, Journal* journal);

} // namespace tessera
