// Scenes: objects, materials and lights. Lengths are in the paper's units: the window is a sphere
// of diameter 7 at the origin. Plain data; concurrent reads are safe.
#pragma once

#include "corpus/pattern.h"
#include "format/texture.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace tessera::corpus {

constexpr double window_radius = 3.5;

// A sphere as a window onto a scene, in the scene's coordinates. It shows what lies behind it, or,
// seen from inside, what lies around it.
struct SphereWindow {
    glm::dvec3 centre{0.0};
    double radius = window_radius;
    bool inside = false;
};

// A set of objects of a scene, one bit per object, for fast culling. It limits a scene to 64
// objects.
using ObjectMask = std::uint64_t;
constexpr std::size_t max_objects = 64;

struct Ray {
    glm::dvec3 origin;
    glm::dvec3 direction; // of unit length
};

struct Material {
    glm::dvec3 colour{0.8};  // diffuse, 0..1
    glm::dvec3 colour2{0.2}; // where the pattern is 1
    Pattern pattern = Pattern::flat;
    double cells = 1.0;      // pattern cells per unit of length, in the object's frame
    double grain = 0.0;      // 0..1: how much noise darkens the colour
    double specular = 0.0;   // 0..1: strength of the white highlight
    unsigned shininess = 32; // Phong's exponent
    double mirror = 0.0;     // 0..1: share of the reflection in the colour
    glm::dvec3 emission{0.0};
};

enum class Shape : std::uint8_t {
    sphere,   // radius half.x
    cylinder, // capped, along local y: radius half.x, half height half.y
    box,      // half sides `half`
    plane,    // rectangle in local y = 0 with half sides half.x and half.z, which may be infinite
};

// A convex body in the world. Rays that start inside see the inner side of its surface.
struct Object {
    Shape shape = Shape::sphere;
    bool rotated = false;
    bool casts_shadow = true;
    glm::dvec3 centre{0.0};
    glm::dvec3 half{0.5};
    glm::dmat3 to_local{1.0}; // rotates world directions into the object's frame
    double bound = 0.5;       // radius of the bounding sphere around `centre`; may be infinite
    Material material;
};

struct Light {
    glm::dvec3 towards{1.0, 0.0, 0.0}; // unit vector from the scene to the light
    double strength = 0.75;
};

struct Scene {
    std::vector<Object> objects; // at most max_objects
    Light light;
    double ambient = 0.25;
    glm::dvec3 background{0.5};
    SampleType type = SampleType::unorm8; // unorm8: display-referred 0..1; half16: scene-linear
    bool shadows = false;                 // hard shadows
    bool lamps_shine = false;             // spheres with emission light other objects
    bool painted = false; // no objects: the window shows `paint`, the same from all directions
    Material paint;
};

Object sphere(const glm::dvec3& centre, double radius, const Material& material);
Object cylinder(const glm::dvec3& centre, double radius, double height, const Material& material);
Object box(const glm::dvec3& centre, const glm::dvec3& sides, const Material& material);
// Faces up, with `width` along x and `depth` along z.
Object plane(const glm::dvec3& centre, double width, double depth, const Material& material);

// The object rotated in place around the world's `axis`, a unit vector; right-handed.
Object turned(Object object, const glm::dvec3& axis, double degrees);

// The front of a plane is the side of the origin, where the window is: 1 if that is the upper side
// in the plane's frame, -1 if it is the lower side.
double front_of(const Object& plane);

// The diffuse colour at `local`, a point in the object's frame.
glm::dvec3 surface_colour(const Material& material, const glm::dvec3& local);

} // namespace tessera::corpus
