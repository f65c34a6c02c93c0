// The results of `tessera bench gpu`, as a table and as JSON.
#pragma once

#include "tools/support/json_text.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// Milliseconds: the median and the 95th percentile.
struct Spread {
    double median = 0, p95 = 0;
};
Spread spread_of(std::vector<double> milliseconds); // zeros for an empty list

// The cost of one way to draw.
struct BenchRow {
    std::string via;     // "raw", "load", "feedback"
    std::string fetches; // "16", "4 filtered"
    std::string frame;   // "steady", or "cold" for a frame that starts with an empty cache
    std::string missing; // why there are no figures; empty if there are some

    Spread device;                                // a whole frame, by the device's clock
    Spread wall;                                  // the same by the host's clock, with waiting
    Spread draw, update;                          // the two parts of a steady frame
    Spread mark, decode, redraw;                  // the three parts of a cold frame
    std::uint64_t bytes = 0;                      // device memory
    std::uint64_t slots = 0;                      // of the tile cache; 0: no cache
    double touched = 0, decoded = 0, waiting = 0; // tiles per frame
    double texels_per_second = 0;                 // over the updates that decoded tiles
    std::optional<double> psnr;                   // dB; infinite if the pictures are equal
};

// The times of decoding without drawing.
struct BenchDecode {
    std::string what;    // "whole file", "cold frame", "steady frames"
    std::string missing; // why there are no figures
    std::uint64_t tiles = 0, texels = 0;
    double upload = 0, entropy = 0, order = 0, transform = 0; // milliseconds in total
    // The time of all stages without stopping between them if it was measured, else their sum.
    double whole = 0;
};

struct BenchReport {
    std::string device, vendor, driver;
    bool software = false;
    std::string file, size;
    std::uint64_t file_bytes = 0, tiles = 0, decoded_bytes = 0, budget = 0;
    double bits_per_texel = 0;
    std::uint64_t blocks = 0, coefficients = 0; // in the whole file; 0: not counted
    std::uint32_t width = 0, height = 0;
    unsigned frames = 0, warm_up = 0, cold_frames = 0, orbit = 0;
    std::string reference; // names the picture that PSNR refers to; empty: none
    std::vector<BenchRow> rows;
    std::vector<BenchDecode> decodes;
};

std::string to_text(const BenchReport& report);
Json to_json(const BenchReport& report);

} // namespace tessera
