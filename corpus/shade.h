// The ray tracer: local shading, hard shadows, mirrors. Pure and thread-safe.
#pragma once

#include "corpus/scene.h"

namespace tessera::corpus {

constexpr ObjectMask every_object = ~ObjectMask{0};

// RGB that arrives along the ray: scene-linear radiance for half16 scenes, clamped to 0..1
// (display-referred) for unorm8 ones. `candidates` says which objects the ray itself can meet; bits
// past the last object are ignored, and shadow and mirror rays always look at every object.
// Precondition: the direction is of unit length, the scene is not `painted`.
glm::dvec3 trace(const Scene& scene, const Ray& ray, ObjectMask candidates = every_object);

// What a camera sees: through the window, the scene along the ray from where it enters the window;
// the background where the ray misses the window. A ray that starts in the window starts there. For
// a painted scene, the paint at the place of entry.
glm::dvec3 trace_scene(const Scene& scene, const Ray& ray);

// A place on an object as the source of the light that leaves it. What stands before the place does not
// matter, what stands in its light or in its mirror does. `scene` must outlive it.
class LitPlace {
public:
    // `local`: in the object's frame, with the unit normal there.
    LitPlace(const Scene& scene, const Object& object, const glm::dvec3& local,
             const glm::dvec3& local_normal);

    const glm::dvec3& position() const { return position_; } // world
    const glm::dvec3& normal() const { return normal_; }
    // Light that leaves along the unit vector `towards`, as trace() would return it for a ray from there.
    // Where that points into the object, the light along its mirror image above the surface.
    glm::dvec3 leaving(const glm::dvec3& towards) const;

private:
    const Scene& scene_;
    const Object& object_;
    glm::dvec3 position_, normal_, colour_;
};

// Whether LitPlace::leaving depends on the direction.
bool shines(const Material& material);

// What a camera sees of the things themselves, without the window: planes from their front only, as a
// mesh of them shows, so that one looks into a closed room. Precondition: as of trace().
glm::dvec3 trace_surfaces(const Scene& scene, const Ray& ray);

// The paint of a painted scene at the place with outward unit normal `normal`.
glm::dvec3 trace_paint(const Scene& scene, const glm::dvec3& normal);

} // namespace tessera::corpus
