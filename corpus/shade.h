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

// The paint of a painted scene at the place with outward unit normal `normal`.
glm::dvec3 trace_paint(const Scene& scene, const glm::dvec3& normal);

} // namespace tessera::corpus
