// Random values of the format, and block shapes from their sides.
#pragma once

#include "format/texture.h"
#include "format/tile/block.h"
#include "format/tile/code_tables.h"
#include "format/tile/tile_filter.h"
#include "tests/support/random.h"

#include <string>

namespace tessera::test {

inline Parameters random_parameters(Random& random) {
    Parameters parameters;
    for (std::uint8_t& p : parameters)
        p = static_cast<std::uint8_t>(random.range(0, parameter_count_of_odds - 1));
    return parameters;
}

// A random filter within the format's range. About half of the rings have a short reach.
inline TileFilter random_filter(Random& random) {
    TileFilter filter;
    for (auto& rings : filter.ring)
        for (FilterRing& ring : rings)
            ring = {static_cast<std::int8_t>(random.range(-127, 127)),
                    static_cast<std::uint8_t>(random.chance(0.5) ? random.range(1, 32)
                                                                 : random.range(1, 255))};
    return filter;
}

inline BlockShape shape_of(int u, int v, int s, int t) {
    return {{static_cast<std::uint16_t>(u), static_cast<std::uint16_t>(v),
             static_cast<std::uint16_t>(s), static_cast<std::uint16_t>(t)}};
}

inline std::string name_of(const BlockShape& shape) {
    return to_string(Extent4{shape.n[0], shape.n[1], shape.n[2], shape.n[3]});
}

} // namespace tessera::test
