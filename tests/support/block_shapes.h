// Block shapes that tests iterate over.
#pragma once

#include "tests/support/format_values.h"

namespace tessera::test::block_shapes {

inline const std::vector<BlockShape> shapes = {
    shape_of(1, 1, 1, 1),  shape_of(32, 32, 8, 8), shape_of(7, 5, 3, 2),
    shape_of(4, 4, 1, 1),  shape_of(17, 9, 5, 3),  shape_of(1, 1, 32, 32),
    shape_of(32, 1, 1, 1), shape_of(31, 2, 29, 3), shape_of(16, 16, 16, 16)};

} // namespace tessera::test::block_shapes
