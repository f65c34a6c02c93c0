// Finds what a tile's cells can copy from their neighbouring views: block matching along s and
// along t.
#pragma once

#include "codec/search_kernels/forward_dct.h"
#include "codec/tile_encoder/bit_costs.h"
#include "codec/tile_encoder/displaced_views.h"
#include "format/tile/prediction.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tessera {

// Displacements that are tried, in half texels per view.
struct DisplacementRange {
    int along = 0;    // farthest in the direction of parallax; 0: copying is not tried
    int across = 0;   // farthest in the other direction
    bool half = true; // half texels as well as whole ones
    // Number of popular whole-texel displacements tried everywhere: those that most of a quarter of
    // a tile's views take, which is searched in full. 0: all.
    int likely = 0;
};

// The displacement chosen for a cell, its squared error in codes, and its bits after the cell
// before.
struct Match {
    Displacement displacement;
    float error = 0, bits = 0;
};

// Holds scratch memory: one per thread.
class DisplacementSearch {
public:
    // `costs` outlives this.
    DisplacementSearch(const BitCosts& costs, const DisplacementRange& range)
        : costs_(&costs), range_(range) {}

    // Forgets which displacements were likely in the tile before.
    void forget_likely() { votes_ = {}; }
    // Takes the source and the decoded views of a tile, see DisplacedViews::begin.
    void begin(const BlockShape& tile, const std::vector<float>& source,
               const std::vector<std::int32_t>& reconstructed, float unit, bool smooth) {
        views_.begin(tile, source, reconstructed, unit, smooth);
    }

    using Axes = std::array<std::vector<Segment>, 2>;
    // The cells of one angular depth and all spatial depths.
    struct Cells {
        Axes angular;              // along s and t
        std::vector<Axes> spatial; // along u and v, coarse to fine
        // By spatial depth and cell: the error at which a copy no longer pays; 0: it is not matched.
        std::vector<std::vector<float>> limit;
    };
    using Matches = std::vector<std::vector<Match>>; // by spatial depth and cell

    // Matches the wanted cells along s (direction 0) or t (1). Others, and cells with no view
    // before them, get an infinite error. `bit_cost`: squared error that a bit is worth.
    void match(int direction, const Cells& cells, float bit_cost, Matches& matches);
    // Matches cells that were matched before, when the views looked nearly the same: each keeps its
    // displacement or takes one of the two before it.
    void match_again(int direction, const Cells& cells, float bit_cost, Matches& matches);

private:
    using Known = std::array<Displacement, 2>; // the last two that differ
    // The best displacement of a cell so far.
    struct Best {
        const Segment &u, &v;
        const Known& known;
        float bit_cost;
        Match match;
        float cost; // of its error and its bits
    };
    void attempt(const Displacement& d, Best& best) const;
    void set_candidates();
    void keep_likely_candidates();
    void set_bits();
    void measure(const std::vector<Axes>& spatial);
    void match_angle(const Cells& cells, float bit_cost, std::size_t angle, Matches& matches);
    void choose(const Axes& cells, const float* limits, const float* errors, float bit_cost,
                Match* matches);
    template <class Visit> void for_each_angle(const Axes& angular, const Visit& visit);
    std::size_t place_of(const Displacement& whole) const;
    bool is_candidate(const Displacement& d) const;
    void add_bits(const float* errors, const Known& known, float bit_cost);
    float component_bits(int component, int difference) const {
        return component_bits_[component][difference + 2 * max_displacement];
    }
    float bits_of(const Displacement& d, const Known& known) const;

    const BitCosts* costs_;
    DisplacementRange range_;
    DisplacedViews views_;
    int direction_ = 0;
    int most_u_ = 0, most_v_ = 0; // of whole candidates, even
    // All whole displacements row by row, or the likely ones in no rows.
    std::vector<Displacement> candidates_;
    std::size_t row_ = 0;                    // candidates in a row; 0: no rows
    std::vector<std::uint8_t> is_candidate_; // by place_of()
    // By direction and place_of(): texels of the cells that took a displacement.
    std::array<std::vector<std::uint32_t>, 2> votes_;
    std::vector<float> errors_; // of an angular cell: [depth, fine first][spatial cell][candidate]
    std::vector<float> costs_of_candidates_; // of a cell: errors and bits
    std::array<float, displacement_kinds> kind_bits_{};
    std::array<std::vector<float>, 2> component_bits_; // of u and v
};

} // namespace tessera
