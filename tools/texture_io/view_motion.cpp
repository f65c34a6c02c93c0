#include "tools/texture_io/view_motion.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {
namespace {

constexpr int most_shift = 24; // pixels
// A direction is clear if the error after its best shift is at most this share of the other's.
constexpr double clear_ratio = 0.7;

// The mean difference where `b` is shifted by (x, y) against `a`, of the pixels that both have.
double difference(const ViewCrop& a, const ViewCrop& b, int x, int y) {
    const int width = static_cast<int>(a.width), height = static_cast<int>(a.height);
    std::uint64_t sum = 0, count = 0;
    for (int row = std::max(0, -y); row < std::min(height, height - y); ++row)
        for (int column = std::max(0, -x); column < std::min(width, width - x); ++column) {
            const auto at = static_cast<std::size_t>(row * width + column);
            const auto to = static_cast<std::size_t>((row + y) * width + column + x);
            sum += static_cast<std::uint64_t>(std::abs(int{a.grey[at]} - int{b.grey[to]}));
            ++count;
        }
    return count > 0 ? static_cast<double>(sum) / static_cast<double>(count) : 255;
}

} // namespace

std::optional<Motion> motion_between(const ViewCrop& a, const ViewCrop& b) {
    const int reach_x = std::min(most_shift, static_cast<int>(a.width / 4));
    const int reach_y = std::min(most_shift, static_cast<int>(a.height / 4));
    const double still = difference(a, b, 0, 0);
    double horizontal = still, vertical = still;
    for (int x = -reach_x; x <= reach_x; ++x)
        horizontal = std::min(horizontal, difference(a, b, x, 0));
    for (int y = -reach_y; y <= reach_y; ++y)
        vertical = std::min(vertical, difference(a, b, 0, y));
    if (horizontal < clear_ratio * vertical)
        return Motion::horizontal;
    if (vertical < clear_ratio * horizontal)
        return Motion::vertical;
    return std::nullopt;
}

} // namespace tessera
