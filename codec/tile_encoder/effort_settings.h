// What an effort switches on: the one place where efforts get their meaning.
#pragma once

#include "codec/tile_encoder/block_quantizer.h"
#include "codec/tile_encoder/block_search.h"
#include "codec/tile_encoder/tool_switches.h"

namespace tessera {

// Figures: codec/DECISIONS.md and tests/regression/results.csv.
struct EffortSettings {
    SearchOptions search;
    QuantizerOptions quantizer;
    bool recode =
        true; // code again under tables fitted to all tiles; else those of the sample stay
    bool dependent = true;      // quantise by a trellis
    bool rotate_colours = true; // try rotated colour axes for every block
    bool ycocg = true;          // code YCoCg, not RGB
    bool fit_tables = true;     // to the sample, and to all tiles
    bool filter = true;         // decoded tiles, where that is worth it
    bool try_smooth = true;     // whether copies are smoothed is found by a trial
    bool try_base = true;       // whether tiles have base pictures, likewise
    bool try_alignment = true;  // of views, by their parallax
    bool try_dense = true;      // whether tables start from those of dense textures, likewise
    bool balance = true;        // tiles keep the mean of their texels
    bool quick = false;         // small samples, tiles' shape by estimates: coding takes no longer
    int copy_rounds = 1;        // of the search for blocks that copy
    int refinements = 1;        // rounds of splitting and merging at what coding really costs

    // Precondition: effort 0..most_effort (codec/encoder.h).
    static EffortSettings of(int effort, const ToolSwitches& tools = {});
    // For passes over a sample, which find tables and make choices for the file: they refine nothing.
    EffortSettings for_samples() const;
};

} // namespace tessera
