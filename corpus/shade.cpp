#include "corpus/shade.h"

#include "corpus/intersect.h"

namespace tessera::corpus {
namespace {

constexpr int max_bounces = 4;
constexpr double surface_offset = 1e-9; // secondary rays start this far above the surface

// The point that a ray met, for shading.
struct ShadedPoint {
    const Object& object;
    glm::dvec3 position; // a little above the surface
    glm::dvec3 normal;   // on the side the ray came from
    glm::dvec3 view;     // unit vector back along the ray
    glm::dvec3 colour;
};

double power(double base, unsigned exponent) {
    double result = 1.0;
    for (; exponent != 0; exponent >>= 1, base *= base)
        if ((exponent & 1u) != 0)
            result *= base;
    return result;
}

ObjectMask all_of(const Scene& scene) {
    return scene.objects.empty() ? 0 : every_object >> (max_objects - scene.objects.size());
}

// Whether the ray misses the object's bounding sphere, so that no exact test is needed.
bool passes_by(const Object& object, const Ray& ray) {
    const glm::dvec3 centre = object.centre - ray.origin;
    const double along = std::max(0.0, glm::dot(centre, ray.direction));
    const glm::dvec3 gap = centre - along * ray.direction;
    return glm::dot(gap, gap) > object.bound * object.bound * (1.0 + 1e-9);
}

ObjectMask near_ray(const Scene& scene, const Ray& ray) {
    ObjectMask mask = 0;
    for (std::size_t i = 0; i < scene.objects.size(); ++i)
        if (!passes_by(scene.objects[i], ray))
            mask |= ObjectMask{1} << i;
    return mask;
}

bool is_lamp(const Object& object) {
    return object.material.emission != glm::dvec3{0.0};
}

// Whether the ray meets an object that casts a shadow within `reach`. Lamps cast no shadow.
bool is_blocked(const Scene& scene, const Ray& ray, double reach) {
    for (const Object& object : scene.objects)
        if (object.casts_shadow && !is_lamp(object) && !passes_by(object, ray) &&
            hit_distance(object, ray, 0.0) < reach)
            return true;
    return false;
}

// The light from the unit direction `towards`: Lambert's cosine plus a Phong highlight.
glm::dvec3 lit_from(const ShadedPoint& point, const glm::dvec3& towards) {
    const double cosine = glm::dot(point.normal, towards);
    if (cosine <= 0.0)
        return glm::dvec3{0.0};
    glm::dvec3 light = point.colour * cosine;
    const Material& material = point.object.material;
    if (material.specular > 0.0) {
        const glm::dvec3 mirrored = 2.0 * cosine * point.normal - towards;
        const double lobe =
            power(std::max(0.0, glm::dot(mirrored, point.view)), material.shininess);
        light += material.specular * lobe;
    }
    return light;
}

glm::dvec3 sunlight(const Scene& scene, const ShadedPoint& point) {
    const glm::dvec3 light = lit_from(point, scene.light.towards) * scene.light.strength;
    const bool dark = light == glm::dvec3{0.0};
    if (!dark && scene.shadows &&
        is_blocked(scene, {point.position, scene.light.towards},
                   std::numeric_limits<double>::infinity()))
        return glm::dvec3{0.0};
    return light;
}

// A glowing sphere lights like a distant point with emission * (radius / distance)^2.
glm::dvec3 lamplight(const Scene& scene, const ShadedPoint& point) {
    glm::dvec3 light{0.0};
    for (const Object& lamp : scene.objects) {
        if (!is_lamp(lamp) || &lamp == &point.object)
            continue;
        const glm::dvec3 way = lamp.centre - point.position;
        const double distance = glm::length(way);
        const double solid = std::min(1.0, lamp.half.x * lamp.half.x / (distance * distance));
        const glm::dvec3 share = lit_from(point, way / distance) * lamp.material.emission * solid;
        if (share == glm::dvec3{0.0} ||
            (scene.shadows && is_blocked(scene, {point.position, way / distance}, distance)))
            continue;
        light += share;
    }
    return light;
}

ShadedPoint shaded_point(const Ray& ray, const Hit& hit) {
    const Object& object = *hit.object;
    const glm::dvec3 position = ray.origin + hit.distance * ray.direction;
    const glm::dvec3 local = to_local(object, position - object.centre);
    glm::dvec3 normal = local_normal(object, local);
    if (object.rotated)
        normal = normal * object.to_local; // multiplies by the transpose, back to the world
    if (glm::dot(normal, ray.direction) > 0.0)
        normal = -normal;
    return {object, position + surface_offset * normal, normal, -ray.direction,
            surface_colour(object.material, local)};
}

glm::dvec3 radiance(const Scene& scene, const Ray& ray, ObjectMask candidates, int bounces);

glm::dvec3 light_leaving(const Scene& scene, const ShadedPoint& point, int bounces) {
    const Material& material = point.object.material;
    glm::dvec3 light = material.emission + point.colour * scene.ambient + sunlight(scene, point);
    if (scene.lamps_shine)
        light += lamplight(scene, point);
    if (material.mirror > 0.0 && bounces < max_bounces) {
        const double twice = 2.0 * glm::dot(point.view, point.normal);
        const Ray mirrored{point.position, glm::normalize(point.normal * twice - point.view)};
        const glm::dvec3 seen = radiance(scene, mirrored, near_ray(scene, mirrored), bounces + 1);
        light += (seen - light) * material.mirror;
    }
    return light;
}

glm::dvec3 radiance(const Scene& scene, const Ray& ray, ObjectMask candidates, int bounces) {
    const Hit hit = nearest_hit(scene, ray, candidates);
    if (hit.object == nullptr)
        return scene.background;
    return light_leaving(scene, shaded_point(ray, hit), bounces);
}

glm::dvec3 displayed(const Scene& scene, const glm::dvec3& light) {
    return traits_of(scene.type).is_float ? light : glm::min(light, glm::dvec3{1.0});
}

} // namespace

glm::dvec3 trace(const Scene& scene, const Ray& ray, ObjectMask candidates) {
    return displayed(scene, radiance(scene, ray, candidates & all_of(scene), 0));
}

LitPlace::LitPlace(const Scene& scene, const Object& object, const glm::dvec3& local,
                   const glm::dvec3& local_normal)
    : scene_(scene), object_(object), normal_(local_normal * object.to_local),
      colour_(surface_colour(object.material, local)) {
    position_ = object.centre + local * object.to_local + surface_offset * normal_;
}

glm::dvec3 LitPlace::leaving(const glm::dvec3& towards) const {
    const double height = glm::dot(towards, normal_);
    const glm::dvec3 view = height < 0.0 ? towards - 2.0 * height * normal_ : towards;
    return displayed(scene_,
                     light_leaving(scene_, {object_, position_, normal_, view, colour_}, 0));
}

glm::dvec3 LitPlace::matte() const {
    Object dull = object_;
    dull.material.specular = 0.0;
    dull.material.mirror = 0.0;
    const glm::dvec3 light = light_leaving(scene_, {dull, position_, normal_, normal_, colour_}, 0);
    return displayed(scene_, light * (1.0 - object_.material.mirror));
}

bool shines(const Material& material) {
    return material.specular > 0.0 || material.mirror > 0.0;
}

glm::dvec3 trace_surfaces(const Scene& scene, const Ray& ray) {
    ObjectMask candidates = all_of(scene);
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        if (object.shape == Shape::plane &&
            to_local(object, ray.direction).y * front_of(object) >= 0.0)
            candidates &= ~(ObjectMask{1} << i);
    }
    return trace(scene, ray, candidates);
}

glm::dvec3 trace_paint(const Scene& scene, const glm::dvec3& normal) {
    return displayed(scene, surface_colour(scene.paint, normal * window_radius));
}

glm::dvec3 trace_scene(const Scene& scene, const Ray& ray) {
    const Chord window = sphere_chord(ray, window_radius);
    if (window.empty() || window.leave < 0.0)
        return displayed(scene, scene.background);
    const glm::dvec3 entry = ray.origin + std::max(0.0, window.enter) * ray.direction;
    if (!scene.painted)
        return trace(scene, {entry, ray.direction});
    const double length = glm::length(entry);
    return trace_paint(scene, length > 0.0 ? entry / length : glm::dvec3{0.0, 0.0, 1.0});
}

} // namespace tessera::corpus
