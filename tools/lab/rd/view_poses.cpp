#include "tools/lab/rd/view_poses.h"

#include <cmath>
#include <numbers>

namespace tessera {

Result<std::vector<Camera>> paper_cameras() {
    std::vector<Camera> cameras;
    for (const NamedPose& view : paper_views()) {
        TESSERA_TRY_ASSIGN(cameras.emplace_back(), make_camera(view.pose, {}));
    }
    return cameras;
}

Result<std::vector<Camera>> spread_cameras(unsigned count, double nearest, double farthest) {
    std::vector<Camera> cameras;
    for (unsigned i = 0; i < count; ++i) {
        const double height = 1 - (2 * i + 1.0) / count;
        const double turn = 2 * std::numbers::pi * i / std::numbers::phi;
        const double across = std::sqrt(1 - height * height);
        // Multiples of another irrational number than that of the turns, so that distance and
        // direction are not correlated.
        const double share = (i + 0.5) * std::numbers::sqrt2;
        const double distance = nearest * std::pow(farthest / nearest, share - std::floor(share));
        const glm::dvec3 eye =
            distance * glm::dvec3(across * std::cos(turn), height, across * std::sin(turn));
        TESSERA_TRY_ASSIGN(cameras.emplace_back(), make_camera({eye, {}}, {45, 320, 240}));
    }
    return cameras;
}

} // namespace tessera
