// Finds what a tile's cells can copy from their neighbouring views: block matching, as motion search
// does it, along s and along t.
#pragma once

#include "codec/search_kernels/forward_dct.h"
#include "codec/tile_encoder/bit_costs.h"
#include "format/tile/prediction.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Displacements that are tried, in half texels a view: up to `along` in the direction of parallax,
// up to `across` in the other.
struct DisplacementRange {
    int along = 0, across = 0; // along 0: copying is not tried at all
    bool half = true;          // half texels, too; else only whole ones
    // Of whole ones, those that are tried everywhere: the ones that a quarter of a tile's views, searched
    // in full, take most. 0: all.
    int likely = 0;
};

// The displacement chosen for one cell, what it leaves (squared error, in the source's units) and
// what it costs to say, after the cell before.
struct Match {
    Displacement displacement;
    float error = 0, bits = 0;
};

class DisplacementSearch {
public:
    // Takes the tile's source (one plane, tile order) and what its views look like decoded. Both are
    // used until the next call; `unit` is one of them in codes. smooth: the filter of the file.
    void begin(const BlockShape& tile, const std::vector<float>& source,
               const std::vector<std::int32_t>& reconstructed, float unit, bool smooth);
    // Another tile: what was likely in the one before is not any more.
    void forget_likely() { votes_ = {}; }

    // Matches the wanted cells of the grids that halve (s, t) into `angular` and (u, v) into spatial[0],
    // spatial[1], ..., coarse to fine. wanted[depth] and matches[depth] are in the order of the grids'
    // cells; others, and cells with nothing before them, keep an infinite error. A bit costs `bit_cost`,
    // in squared error.
    using Axes = std::array<std::vector<Segment>, 2>;
    using Wanted = std::vector<std::vector<std::uint8_t>>; // 0: not
    void match(int direction, const Axes& angular, const std::vector<Axes>& spatial,
               const Wanted& wanted, const DisplacementRange& range, const BitCosts& costs,
               float bit_cost, std::vector<std::vector<Match>>& matches);
    // The same of cells that were matched before, when the views looked nearly alike: each has
    // what it had or what one of the two cells before it has.
    void match_again(int direction, const Axes& angular, const std::vector<Axes>& spatial,
                     const Wanted& wanted, const BitCosts& costs, float bit_cost,
                     std::vector<std::vector<Match>>& matches);

private:
    // The best displacement of a cell so far.
    struct Best {
        const Segment &u, &v;
        const std::array<Displacement, 2>& known;
        float bit_cost;
        Match match;
        float least;
    };
    void attempt(const Displacement& d, Best& best) const;
    void make_phases(const std::vector<std::int32_t>& reconstructed, float unit, bool smooth);
    void set_candidates(const DisplacementRange& range);
    void set_likely_candidates(const DisplacementRange& range);
    void set_bits(int direction, const BitCosts& costs);
    void measure_all(const std::vector<Axes>& spatial);
    void match_angular_cell(const std::vector<Axes>& spatial, const Wanted& wanted,
                            const DisplacementRange& range, float bit_cost, std::size_t angle,
                            std::vector<std::vector<Match>>& matches);
    void choose(const Axes& cells, const std::uint8_t* wanted, const float* errors, bool half,
                float bit_cost, Match* matches);
    void choose_again(const Axes& cells, const std::uint8_t* wanted, float bit_cost,
                      Match* matches) const;
    // Calls visit(angle) for every angular cell that has views before it, in hand then.
    template <class Visit> void for_each_angle(const Axes& angular, const Visit& visit);
    std::size_t place_of(const Displacement& d) const;
    bool is_candidate(const Displacement& d) const;
    void vote(const Displacement& whole, int texels);
    void total_likely(const float* own, const std::array<Displacement, 2>& known, float bit_cost);
    void total_candidates(const float* own, const std::array<Displacement, 2>& known,
                          float bit_cost);
    // Calls visit(own texels, those that it would copy, rows between these) for each view of the angular cell in hand,
    // at the first of the texels u, until it returns false.
    template <class Visit>
    void for_each_view(const Displacement& d, const Segment& u, const Visit& visit) const;
    // If it is more than `enough`, something between.
    float error_of(const Displacement& d, const Segment& u, const Segment& v, float enough) const;
    float bits_of(const Displacement& d, const std::array<Displacement, 2>& known) const;

    BlockShape tile_;
    // In units as fine as its texels let them be; the square of one, in codes.
    std::vector<std::int16_t> source_;
    float squared_unit_ = 1;
    // The decoded plane in the same units, at whole and half texels, [half along v][half along u]; rows reach a tile's
    // width past both edges.
    std::array<std::array<std::vector<std::int16_t>, 2>, 2> phase_;
    int direction_ = 0;
    int most_u_ = 0, most_v_ = 0;            // of whole candidates, even
    Segment s_, t_;                          // the angular cell in hand
    std::vector<Displacement> candidates_;   // row after row
    std::size_t candidates_u_ = 0;           // of a row; 0: only likely ones, in no rows
    std::vector<std::uint8_t> is_candidate_; // of those in rows
    // Of a direction's candidates, in rows: texels of the cells that took them.
    std::array<std::vector<std::uint32_t>, 2> votes_;
    std::vector<float> errors_; // of that cell: [depth, fine first][spatial cell][candidate]
    std::vector<float> totals_, sums_;
    std::array<float, displacement_kinds> kind_bits_{};
    std::array<std::vector<float>, 2> component_bits_; // of u, of v: [difference + 2 * max]
};

} // namespace tessera
