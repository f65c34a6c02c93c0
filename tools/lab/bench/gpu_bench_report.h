// What `tessera bench gpu` found out, as a table and as JSON.
#pragma once

#include "tools/support/json_text.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// Milliseconds: the middle one and the one that 95 in 100 do not exceed.
struct Spread {
    double median = 0, p95 = 0;
};
Spread spread_of(std::vector<double> milliseconds); // zeros where there are none

// One way to draw, and what it costs.
struct BenchRow {
    std::string via;     // "raw", "load", "feedback"
    std::string fetches; // "16", "4 filtered"
    std::string frame;   // "steady"; "cold": from an empty cache
    std::string missing; // why there are no figures; empty: there are

    Spread device;                                // a whole frame
    Spread wall;                                  // the same by the host's clock, waiting and all
    Spread draw, update;                          // steady: the two parts of it
    Spread mark, decode, redraw;                  // cold: the three parts of it
    std::uint64_t bytes = 0;                      // held on the device
    std::uint64_t slots = 0;                      // of the tile cache
    double touched = 0, decoded = 0, waiting = 0; // tiles a frame
    double texels_per_second = 0;                 // of the updates that decoded something
    std::optional<double> psnr;                   // dB; infinite: the same picture
};

// Decoding alone.
struct BenchDecode {
    std::string what;    // "whole file", "cold frame", "steady frames"
    std::string missing; // why there are no figures
    std::uint64_t tiles = 0, texels = 0;
    double upload = 0, entropy = 0, order = 0, transform = 0; // milliseconds in all
    // Of all without stopping between the stages, where that was measured; else their sum.
    double whole = 0;
};

struct BenchReport {
    std::string device, vendor, driver;
    bool software = false;
    std::string file, size;
    std::uint64_t file_bytes = 0, tiles = 0, decoded_bytes = 0, budget = 0;
    double bits_per_texel = 0;
    std::uint64_t blocks = 0, coefficients = 0; // of the whole file; 0: not counted
    std::uint32_t width = 0, height = 0;
    unsigned frames = 0, warm_up = 0, cold_frames = 0, orbit = 0;
    std::string reference; // what PSNR is measured against; empty: nothing
    std::vector<BenchRow> rows;
    std::vector<BenchDecode> decodes;
};

std::string to_text(const BenchReport& report);
Json to_json(const BenchReport& report);

} // namespace tessera
