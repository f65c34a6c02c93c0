// The surfaces that a texture can be fitted to: where a ray meets them, and what it shows there.
#pragma once

#include "corpus/scene.h"
#include "corpus/trace/ray_scene.h"
#include "format/surface_mesh.h"

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tessera::corpus {

// What a ray of a pixel shows of a texture.
struct PhotoSample {
    float u, v; // place on the surface, 0..1
    // The direction, 0..1. On a mesh: mirrored about the normal, octahedral. On a sphere: see
    // place_of_direction(). In a window: where the ray crosses the plane of the cameras.
    float s, t;
    float weight; // of the ray in its pixel; the weights of all rays of a pixel add up to 1
};

// The unit vector from a place of a sphere to its observer, in the world's frame, as two numbers of
// 0..1, and back: an octahedral map of all directions.
std::array<float, 2> place_of_direction(const glm::vec3& direction);
glm::vec3 direction_at(float s, float t);

// Implementations are immutable and thread-safe.
class SeenSurface {
public:
    virtual ~SeenSurface() = default;
    // What the ray shows, with weight 1; nothing if it misses the surface or meets its back.
    // `direction` has unit length.
    virtual std::optional<PhotoSample> seen(const glm::dvec3& eye,
                                            const glm::dvec3& direction) const = 0;
    // The message if no photograph sees the surface.
    virtual std::string unseen() const = 0;
};

class SeenMesh final : public SeenSurface {
public:
    // Error: runtime, from Embree.
    static Result<SeenMesh> make(SurfaceMesh mesh);
    const SurfaceMesh& mesh() const { return mesh_; }
    std::optional<PhotoSample> seen(const glm::dvec3& eye,
                                    const glm::dvec3& direction) const override;
    std::string unseen() const override;

private:
    SeenMesh(SurfaceMesh mesh, RayScene rays)
        : mesh_(std::move(mesh)), tangents_(mesh_tangents(mesh_)), rays_(std::move(rays)) {}

    SurfaceMesh mesh_;
    std::vector<glm::vec3> tangents_;
    RayScene rays_;
};

// A sphere that is seen from outside.
class SeenSphere final : public SeenSurface {
public:
    SeenSphere(const glm::dvec3& centre, double radius) : centre_(centre), radius_(radius) {}
    std::optional<PhotoSample> seen(const glm::dvec3& eye,
                                    const glm::dvec3& direction) const override;
    std::string unseen() const override;

private:
    glm::dvec3 centre_;
    double radius_;
};

// A window that cameras look through, as planar views have it (FORMAT.md 5.3), anywhere in the
// world. Lengths are world units.
struct PhotoWindow {
    glm::dvec3 centre{0.0};
    glm::dmat3 axes{1.0};         // columns: right, up and towards the cameras; a rotation
    double width = 1, height = 1; // of the window
    double distance = 1;          // of the plane of the cameras
    double spacing_x = 1, spacing_y = 1;
    std::array<std::uint32_t, 2> cameras{1, 1}; // along s and t

    // In the window's frame, whose origin is its centre.
    glm::dvec3 local(const glm::dvec3& place) const {
        return (place - centre) * axes; // the transpose of a rotation is its inverse
    }
};

class SeenWindow final : public SeenSurface {
public:
    explicit SeenWindow(const PhotoWindow& window) : window_(window) {}
    std::optional<PhotoSample> seen(const glm::dvec3& eye,
                                    const glm::dvec3& direction) const override;
    std::string unseen() const override;

private:
    PhotoWindow window_;
};

} // namespace tessera::corpus
