// What each effort switches on; the only place that knows.
#pragma once

#include "codec/tile_encoder/block_quantizer.h"
#include "codec/tile_encoder/block_search.h"
#include "codec/tile_encoder/tool_switches.h"

namespace tessera {

// Figures: codec/DECISIONS.md and tests/regression/results.csv.
// How pictures are searched (PictureEncoder).
struct PictureSearch {
    int coded_modes = 0;       // border modes of a block that are coded in full; 0: no border modes
    int transform_modes = 0;   // the cheapest of these, which are also coded with sines
    bool no_transform = false; // ... and without a transform along one axis or both
    bool halves = false;       // blocks may be halves of squares,
    bool quarters = false;     // ... and quarters along one side,
    bool crossed_halves = false; // ... and halves of halves along the other side
    bool plane_trees = false;    // each of two planes may have a tree of its own,
    bool careful_trees = false;  // ... if that is cheaper with directions, too
    bool borders = true;         // blocks are predicted from their borders
    bool planar = true;          // ... as a plane,
    bool directions = true;      // ... along a direction, and always as their mean
};

struct EffortSettings {
    SearchOptions search;
    QuantizerOptions quantizer;
    bool recode = true;         // code again with tables fitted to all tiles, not only to a sample
    bool dependent = true;      // dependent quantisation, by a trellis
    bool rotate_colours = true; // try rotated colour axes for every block
    bool chroma_from_luma = true; // predict Co and Cg from luma
    bool ycocg = true;            // instead of RGB
    bool fit_tables = true;       // to the sample, and to all tiles
    bool filter = true;           // fit a filter, if that is worth it
    bool try_smooth = true;       // a trial decides whether copies are smoothed,
    bool try_base = true;         // ... whether tiles have base pictures,
    bool try_alignment = true;    // ... whether views are aligned,
    bool try_dense = true;        // ... whether tables are learnt from a dense start
    bool balance = true;          // tiles keep the mean of their texels
    bool quick = false;           // small samples, and estimates to choose tiles' shape
    bool code_both_fills = true;  // of masked tiles, instead of comparing estimates
    int copy_rounds = 1;          // of the search for blocks that copy
    PictureSearch pictures;
    bool quick_bases = false; // base pictures are searched quickly in the last round, too
    int refinements = 1;      // rounds of splitting and merging at real costs

    // For base pictures that are coded again in a later round.
    PictureSearch quick_pictures() const;

    // Precondition: effort is 0..most_effort (codec/encoder.h).
    static EffortSettings of(int effort, const ToolSwitches& tools = {},
                             bool is_small_picture = false);
    // For passes over a sample, which choose tables and tools for the file and refine nothing.
    EffortSettings for_samples() const;
};

} // namespace tessera
