// Triangles that rays can be shot at: Embree's scene, for models and for the meshes of views.
#pragma once

#include "format/status.h"

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>

namespace tessera::corpus {

// Where a ray meets a triangle.
struct RayHit {
    std::uint32_t triangle = 0;
    glm::dvec2 barycentric{0.0}; // weights of the second and third corner
    double distance = 0;         // along the ray, in lengths of its direction
    bool back = false;           // the corners run clockwise, seen along the ray
};

// Immutable, hence thread-safe. No ray slips between two triangles that share an edge.
class RayScene {
public:
    // Whether the triangle lets rays pass at a front that they meet.
    using Passes = std::function<bool(std::uint32_t triangle, const glm::dvec2& barycentric)>;

    // Copies positions and triangles; `fronts_only`: rays pass backs. `passes` is called by whichever
    // thread shoots, with fronts only. Errors: runtime, what Embree says.
    static Result<RayScene> make(std::span<const glm::vec3> positions,
                                 std::span<const std::array<std::uint32_t, 3>> triangles,
                                 bool fronts_only, Passes passes = {});
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;
    ~RayScene();

    std::optional<RayHit> first_hit(const glm::dvec3& origin, const glm::dvec3& direction) const;
    bool is_blocked(const glm::dvec3& origin, const glm::dvec3& direction) const;

private:
    struct State;
    explicit RayScene(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace tessera::corpus
