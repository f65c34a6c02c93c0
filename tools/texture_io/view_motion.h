// Which way the content of views moves from one camera to the next.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace tessera {

// Brightness of a part of a view, rows from the top.
struct ViewCrop {
    std::uint32_t width = 0, height = 0; // pixels
    std::vector<std::uint8_t> grey;
};

enum class Motion { horizontal, vertical };

// How `b` is shifted against `a`, the same part of another view. Nothing where no shift explains the
// difference clearly better than the other direction does, as in flat or equal views.
std::optional<Motion> motion_between(const ViewCrop& a, const ViewCrop& b);

} // namespace tessera
