// Section CODE: steps, filter and tables (FORMAT.md 3.5).
#pragma once

#include "tests/reference/spec_container.h"
#include "tests/reference/spec_entropy.h"

#include <array>
#include <optional>

namespace tessera_reference::spec {

struct Step {
    int64_t m = 0;
    int e = 0;
};

struct Ring { // one ring of the filter
    int strength = 0, reach = 1;
};

struct Code {
    std::array<Step, 4> step;
    Step rotated_step;
    int offset[2][2] = {}; // [plane 0, others][magnitude 1, larger]
    std::array<int, 4> scan_weight = {48, 60, 16, 14};
    int64_t correction_error = 0;
    bool has_colour_symbols = false;
    bool has_predictions = false;
    bool dependent = false;
    bool leaves_out_transforms = false; // flag 10
    bool transforms_any_plane = false;  // flag 11
    bool has_plane_trees = false;       // flag 12
    bool smooth_copies = false;
    std::optional<int> base_margin; // set if the file has base pictures
    bool v_against_u = false;
    std::optional<std::array<std::array<Ring, 3>, 2>> filter; // [plane 0, others][ring]

    uint32_t zero[2][2][7][6][16]; // frequencies of 0
    Table magnitude[2][2][66];
    Table first_length[18];
    Table other_length[14];
    Table split[6][6];
    Table correction[21];
    Table colour[3];
    Table share[2];
    Table prediction[6];
    Table displacement_kind[2];
    Table displacement[2];
    Table base;
    Table from_base[2];
    Table base_displacement;
    Table mode[9];
    Table transform[12];
};

Code read_code(Bytes section, const Header& header);

} // namespace tessera_reference::spec
