// What all passes over one texture have in common.
#pragma once

#include "codec/encoder.h"
#include "codec/journal/journal.h"
#include "codec/tile/tile_planes.h"
#include "codec/tile_encoder/effort_settings.h"
#include "format/levels.h"
#include "format/tile/base_picture.h"

namespace tessera {

// Where views are aligned, `source`, `mask`, `grid` and `colour.desc` describe the grid in which the
// aligned views lie; elsewhere that is the texture itself.
struct EncodePlan {
    TexelSource& source;
    const EncodeOptions& options;
    TileGrid grid = {};
    ColourCoding colour = {};
    EffortSettings effort = {};
    Journal* journal = nullptr;  // nullptr: payloads stay in memory
    TexelSource* mask = nullptr; // nullptr: all texels matter
    std::uint64_t texels_that_matter = 0;
    ToolSwitches tools = {};
    bool keeps_payloads = true; // of whole passes; otherwise only the figures are wanted
    const Decoder* reused =
        nullptr; // tiles that this file still decodes to are kept (tile_reuse.h)
    AlignedViews views = {};
    // Base pictures that follow the parallax of the views; off where the views show none.
    BasePictures parallax = {};
};

inline Status check_cancelled(const EncodePlan& plan) {
    return plan.options.cancelled && plan.options.cancelled()
               ? Status(ErrorCode::runtime, "interrupted")
               : Status();
}

inline void report_progress(const EncodePlan& plan, const char* stage, double done, double total) {
    if (plan.options.progress)
        plan.options.progress(stage, done, total);
}

// An error about the texels, prefixed with the caller's name for them.
inline Status about_texels(const EncodePlan& plan, const Status& status) {
    const std::string& name = plan.options.labels.source;
    return name.empty() ? status : status.with_context(name);
}

} // namespace tessera
