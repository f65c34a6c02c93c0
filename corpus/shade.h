// The ray tracer of the built-in scenes: local shading, hard shadows, mirrors. Pure and
// thread-safe.
#pragma once

#include "corpus/scene.h"

namespace tessera::corpus {

constexpr ObjectMask every_object = ~ObjectMask{0};

// The RGB that arrives along the ray: scene-linear radiance for half16 scenes, display-referred
// 0..1 for unorm8 scenes. `candidates` are the objects that the ray itself can meet; bits past the
// last object are ignored. Shadow rays and reflected rays can meet every object. Precondition: the
// direction has unit length, and the scene is not `painted`.
glm::dvec3 trace(const Scene& scene, const Ray& ray, ObjectMask candidates = every_object);

// The view of a camera through the window. A ray starts where it enters the window, or where the
// camera is if that is inside; a ray that misses the window sees the background. A painted scene
// shows its paint at the place of entry.
glm::dvec3 trace_scene(const Scene& scene, const Ray& ray);

// The light that leaves a place on an object. Objects in front of the place do not matter; objects
// that shadow it or that it reflects do. `scene` must outlive it.
class LitPlace {
public:
    // `local` is the place and `local_normal` the unit normal there, in the object's frame.
    LitPlace(const Scene& scene, const Object& object, const glm::dvec3& local,
             const glm::dvec3& local_normal);

    const glm::dvec3& position() const { return position_; } // world
    const glm::dvec3& normal() const { return normal_; }
    // The light that leaves along the unit vector `towards`, as trace() returns it for a ray that
    // comes from there. A vector into the object stands for its mirror image above the surface.
    glm::dvec3 leaving(const glm::dvec3& towards) const;
    // What of it is the same towards all sides: light without highlights and mirror images.
    glm::dvec3 matte() const;

private:
    const Scene& scene_;
    const Object& object_;
    glm::dvec3 position_, normal_, colour_;
};

// Whether LitPlace::leaving() depends on the direction.
bool shines(const Material& material);

// The view of a camera onto the objects themselves, without the window. Planes are visible from the
// front only, as in a mesh of them, so a camera outside a closed room looks into it. Precondition:
// as for trace().
glm::dvec3 trace_surfaces(const Scene& scene, const Ray& ray);

// The paint of a painted scene at the place of the window with the outward unit normal `normal`.
glm::dvec3 trace_paint(const Scene& scene, const glm::dvec3& normal);

} // namespace tessera::corpus
