// One walk over a texture at fixed parameters: every tile searched, quantised, coded, measured.
#pragma once

#include "codec/encoder.h"
#include "codec/entropy/tile_entropy.h"
#include "codec/fit/filter_fit.h"
#include "codec/journal/journal.h"
#include "codec/journal/tile_store.h"
#include "codec/texels/slabs.h"
#include "codec/tile/tile_texels.h"
#include "codec/tile_encoder/tile_encoder.h"
#include "codec/tile_encoder/tool_switches.h"
#include "format/levels.h"
#include "format/tile/coding_parameters.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// What stays the same over all passes of one encode.
struct EncodePlan {
    TexelSource& source;
    const EncodeOptions& options;
    TileGrid grid;
    ColourCoding colour;
    EffortSettings effort;
    Journal* journal = nullptr;  // nullptr: payloads stay in memory
    TexelSource* mask = nullptr; // of texels that matter; nullptr: all do
    std::uint64_t texels_that_matter = 0;
    ToolSwitches tools = {};    // options.tools, parsed
    bool keeps_payloads = true; // of whole passes; else only the figures are wanted
    const Decoder* reused =
        nullptr; // tiles that this file decodes to are taken over (tile_reuse.h)
    // Where views are aligned, `source`, `mask` and `grid` are of the grid of tiles, and so is colour.desc.
    AlignedViews views = {};
    // The base pictures that follow the parallax of its views; off, where they show none, as on surfaces.
    BasePictures parallax = {};
};

struct PassResult {
    unsigned number = 0;         // 1 for the first over the whole texture; 0: of a sample
    CodingParameters walked;     // that the texture was walked with
    CodingParameters parameters; // that the payloads are coded with
    std::vector<CodedTile> tiles;
    std::shared_ptr<TileStore>
        payloads; // of `tiles`; nullptr for a sample, for a plan that keeps none, and for a pass of which
                  // a journal kept no more than the totals
    PassTotals totals;
    // Of a sample's tiles: blocks, copies and colours, and the levels of base pictures.
    std::vector<TileLevels> trees;

    // texels: those that matter.
    double psnr(const TextureDesc& desc, std::uint64_t texels) const;
    std::uint64_t payload_bytes() const;
};

// Texels of some tiles, held in memory.
struct Sample {
    std::vector<Box4> boxes;       // of the tiles
    std::vector<TileTexels> tiles; // finite

    std::uint64_t texel_count() const;
    std::uint64_t texels_that_matter() const;
};

// The texels of a box, all finite, for a sample. Errors: those of the sources.
Result<TileTexels> read_finite(TexelSource& source, TexelSource* mask, const Box4& box);

// The i-th of picks that the golden ratio spreads over 0..count-1, however many they are.
inline std::uint64_t golden_pick(std::uint64_t i, std::uint64_t count) {
    const double place = 0.6180339887498949 * static_cast<double>(i) + 0.5;
    return std::min(count - 1, static_cast<std::uint64_t>((place - std::floor(place)) *
                                                          static_cast<double>(count)));
}

// The error that ends an encode whose caller does not want it any more.
inline Status check_cancelled(const EncodeOptions& options) {
    return options.cancelled && options.cancelled() ? Status(ErrorCode::runtime, "interrupted")
                                                    : Status();
}

// An error about the texels, which begins with what the caller calls them.
inline Status about_texels(const EncodePlan& plan, const Status& status) {
    const std::string& name = plan.options.source_name;
    return name.empty() ? status : status.with_context(name);
}

// Slabs of the whole texture that plan.options.slab_bytes allows.
Result<std::vector<Slab>> slabs_of(const EncodePlan& plan);

// Reads a spread of the tiles: about an eighth of them, or a sixteenth where tables are all that a
// sample is for and are fitted again in the end, between 4 and 128; or as many as `wanted`.
Result<Sample> read_sample(const EncodePlan& plan);
Result<Sample> read_sample(const EncodePlan& plan, std::uint64_t wanted);

// Encodes every tile of the texture but those that the journal holds of an earlier run. `number`
// counts passes, from 1. Errors: the source's; the journal's; invalid_file (strict and non-finite).
Result<PassResult> run_pass(const EncodePlan& plan, const CodingParameters& parameters,
                            unsigned number, const char* stage);
// Encodes the sample's tiles only. `filter`: adds what a filter would have to mend; only where
// `parameters` have none.
Result<PassResult> run_pass(const EncodePlan& plan, const CodingParameters& parameters,
                            const Sample& sample, FilterStatistics* filter = nullptr);
// Only what such a pass counts, in half its time. Precondition: a plan without corrections.
Result<Statistics> count_symbols(const EncodePlan& plan, const CodingParameters& parameters,
                                 const Sample& sample);
// Codes the sample's tiles again in the `trees` of an earlier pass over it, in a tenth of its time; the
// same, and what it would count. Preconditions: the tiles of that pass, its base pictures, no corrections.
Result<PassResult> run_pass_as(const EncodePlan& plan, const CodingParameters& parameters,
                               const Sample& sample, std::span<const TileLevels> trees);
Result<Statistics> count_symbols_as(const EncodePlan& plan, const CodingParameters& parameters,
                                    const Sample& sample, std::span<const TileLevels> trees);
// What the search takes each of the sample's tiles to cost without copies, about lagrangian_cost of such a
// pass, in a third of its time.
Result<std::vector<float>>
estimated_costs(const EncodePlan& plan, const CodingParameters& parameters, const Sample& sample);

// A tile's squared error in steps of the first plane, and what its bytes are worth: less is better,
// among ways to code the same texels with the same steps.
double lagrangian_cost(const EncodePlan& plan, const CodingParameters& parameters,
                       const CodedTile& tile);
// Of all tiles of a pass.
double lagrangian_cost(const EncodePlan& plan, const PassResult& pass);

// Codes all tiles again under tables fitted to them, and parses each to check it (runtime error if
// its levels differ from what was measured) unless the options say no. Needs pass.payloads.
Status recode_with_fitted_tables(const EncodePlan& plan, PassResult& pass);

// Squared and largest error of sample codes between texels of one size, into `tile`.
void measure_error(std::span<const std::byte> a, std::span<const std::byte> b, SampleType type,
                   CodedTile& tile);

// NaN -> 0, infinities -> +-65504. No effect on unorm8.
void make_finite(std::span<std::byte> texels, SampleType type, CodedTile& counts);

} // namespace tessera
