// Where rays meet objects. Inline because the baker calls these functions billions of times. Pure.
#pragma once

#include "corpus/scene.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace tessera::corpus {

// The part of a line inside a convex object: enter <= distance <= leave. Empty if enter > leave. A
// part that lies wholly behind the ray's start may be omitted.
struct Chord {
    double enter = -std::numeric_limits<double>::infinity();
    double leave = std::numeric_limits<double>::infinity();

    static constexpr Chord none() { return {1.0, 0.0}; }
    bool empty() const { return enter > leave; }
    void clip(const Chord& other) {
        enter = std::max(enter, other.enter);
        leave = std::min(leave, other.leave);
    }
};

inline glm::dvec3 to_local(const Object& object, const glm::dvec3& world_direction) {
    return object.rotated ? object.to_local * world_direction : world_direction;
}

// The ray in the object's frame, whose origin is the object's centre. Distances stay the same.
inline Ray local_ray(const Object& object, const Ray& ray) {
    return {to_local(object, ray.origin - object.centre), to_local(object, ray.direction)};
}

// The distances at which |o + distance * d| <= half along one axis. A ray parallel to the slab is
// always or never inside; a division would give NaN for a ray that runs within its face.
inline Chord slab_chord(double o, double d, double half) {
    if (d == 0.0)
        return std::abs(o) <= half ? Chord{} : Chord::none();
    const double inverse = 1.0 / d;
    const double a = (-half - o) * inverse;
    const double b = (half - o) * inverse;
    return {std::min(a, b), std::max(a, b)};
}

// The discriminant is computed from the foot of the perpendicular. b^2 - a c would lose its digits
// for rays that graze a small sphere far away.
inline Chord sphere_chord(const Ray& ray, double radius) {
    const double middle = -glm::dot(ray.origin, ray.direction);
    const glm::dvec3 foot = ray.origin + middle * ray.direction;
    const double rest = radius * radius - glm::dot(foot, foot);
    if (!(rest >= 0.0))
        return Chord::none();
    const double half = std::sqrt(rest);
    return {middle - half, middle + half};
}

// Infinite cylinder along y.
inline Chord tube_chord(const Ray& ray, double radius) {
    const double a = ray.direction.x * ray.direction.x + ray.direction.z * ray.direction.z;
    const double c = ray.origin.x * ray.origin.x + ray.origin.z * ray.origin.z;
    if (a < 1e-24) // parallel to the axis
        return c <= radius * radius ? Chord{} : Chord::none();
    const double middle = -(ray.origin.x * ray.direction.x + ray.origin.z * ray.direction.z) / a;
    const double x = ray.origin.x + middle * ray.direction.x;
    const double z = ray.origin.z + middle * ray.direction.z;
    const double rest = radius * radius - (x * x + z * z);
    if (!(rest >= 0.0))
        return Chord::none();
    const double half = std::sqrt(rest / a);
    return {middle - half, middle + half};
}

// A plane's chord is one point. A ray that runs within the plane misses it. The distance needs only
// the normal: most tested planes lie behind the ray, and need no full rotation.
inline Chord plane_chord(const Object& object, const Ray& ray) {
    const glm::dmat3& m = object.to_local;
    const glm::dvec3 normal{m[0].y, m[1].y, m[2].y};
    const glm::dvec3 origin = ray.origin - object.centre;
    const double fall = glm::dot(normal, ray.direction);
    if (fall == 0.0)
        return Chord::none();
    const double distance = -glm::dot(normal, origin) / fall;
    if (distance < 0.0)
        return Chord::none();
    const glm::dvec3 local = to_local(object, origin + distance * ray.direction);
    const bool inside = std::abs(local.x) <= object.half.x && std::abs(local.z) <= object.half.z;
    return inside ? Chord{distance, distance} : Chord::none();
}

inline Chord object_chord(const Object& object, const Ray& ray) {
    if (object.shape == Shape::sphere)
        return sphere_chord({ray.origin - object.centre, ray.direction}, object.half.x);
    if (object.shape == Shape::plane)
        return plane_chord(object, ray);
    const Ray local = local_ray(object, ray);
    Chord chord = slab_chord(local.origin.y, local.direction.y, object.half.y);
    if (object.shape == Shape::cylinder) {
        chord.clip(tube_chord(local, object.half.x));
    } else {
        chord.clip(slab_chord(local.origin.x, local.direction.x, object.half.x));
        chord.clip(slab_chord(local.origin.z, local.direction.z, object.half.z));
    }
    return chord;
}

// The first distance above `nearest` at which the ray meets the surface; infinity for a miss. A ray
// that starts inside meets the surface where it leaves.
inline double hit_distance(const Object& object, const Ray& ray, double nearest) {
    const Chord chord = object_chord(object, ray);
    if (!chord.empty()) {
        if (chord.enter > nearest)
            return chord.enter;
        if (chord.leave > nearest)
            return chord.leave;
    }
    return std::numeric_limits<double>::infinity();
}

// The outward normal at `local`, a point on the surface up to rounding. Both are in the object's
// frame.
inline glm::dvec3 local_normal(const Object& object, const glm::dvec3& local) {
    const glm::dvec3& half = object.half;
    if (object.shape == Shape::sphere)
        return local / half.x;
    if (object.shape == Shape::plane)
        return {0.0, 1.0, 0.0};
    const glm::dvec3 cap{0.0, local.y < 0.0 ? -1.0 : 1.0, 0.0};
    const double y = std::abs(local.y) / half.y;
    if (object.shape == Shape::cylinder) {
        const double radial = std::sqrt(local.x * local.x + local.z * local.z);
        return radial / half.x < y ? cap : glm::dvec3{local.x / radial, 0.0, local.z / radial};
    }
    const double x = std::abs(local.x) / half.x;
    const double z = std::abs(local.z) / half.z;
    if (y >= x && y >= z)
        return cap;
    return x >= z ? glm::dvec3{local.x < 0.0 ? -1.0 : 1.0, 0.0, 0.0}
                  : glm::dvec3{0.0, 0.0, local.z < 0.0 ? -1.0 : 1.0};
}

struct Hit {
    const Object* object = nullptr; // null for a miss
    double distance = std::numeric_limits<double>::infinity();
};

// The object of `mask` that the ray meets first; of several at the same distance the first one.
inline Hit nearest_hit(const Scene& scene, const Ray& ray, ObjectMask mask) {
    Hit hit;
    for (; mask != 0; mask &= mask - 1) {
        const Object& object = scene.objects[static_cast<std::size_t>(std::countr_zero(mask))];
        const double distance = hit_distance(object, ray, 0.0);
        if (distance < hit.distance)
            hit = {&object, distance};
    }
    return hit;
}

} // namespace tessera::corpus
