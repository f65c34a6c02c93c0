// Rays against triangles, by Embree. For models and for the meshes that views draw.
#pragma once

#include "format/status.h"

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>

namespace tessera::corpus {

// Where a ray meets a triangle.
struct RayHit {
    std::uint32_t triangle = 0;
    glm::dvec2 barycentric{0.0}; // weights of the second and third corner
    double distance = 0;         // along the ray, in lengths of its direction
    bool back = false;           // the corners are clockwise, seen along the ray
};

// Immutable and thread-safe. No ray passes between two triangles that share an edge.
class RayScene {
public:
    // Whether a ray passes through the front of the triangle at this place.
    using Passes = std::function<bool(std::uint32_t triangle, const glm::dvec2& barycentric)>;

    // Copies positions and triangles. With `fronts_only`, rays pass through backs, and the thread
    // of a ray calls `passes` for the fronts that it meets. Error: runtime, from Embree.
    static Result<RayScene> make(std::span<const glm::vec3> positions,
                                 std::span<const std::array<std::uint32_t, 3>> triangles,
                                 bool fronts_only, Passes passes = {});
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;
    ~RayScene();

    std::optional<RayHit> first_hit(const glm::dvec3& origin, const glm::dvec3& direction) const;
    // Whether the ray meets a triangle within `reach`, in lengths of its direction.
    bool is_blocked(const glm::dvec3& origin, const glm::dvec3& direction,
                    double reach = std::numeric_limits<double>::infinity()) const;

private:
    struct State;
    explicit RayScene(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace tessera::corpus
