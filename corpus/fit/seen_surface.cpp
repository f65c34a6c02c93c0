#include "corpus/fit/seen_surface.h"

#include "format/layers.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

float sign_of(float x) {
    return x < 0.0f ? -1.0f : 1.0f;
}

PhotoSample sample_of(const glm::dvec2& uv, const glm::dvec2& st) {
    return {static_cast<float>(uv.x), static_cast<float>(uv.y), static_cast<float>(st.x),
            static_cast<float>(st.y), 1.0f};
}

} // namespace

std::array<float, 2> place_of_direction(const glm::vec3& direction) {
    const glm::vec3 d =
        direction / (std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z));
    float x = d.x, y = d.y;
    if (d.z < 0.0f) {
        x = (1.0f - std::abs(d.y)) * sign_of(d.x);
        y = (1.0f - std::abs(d.x)) * sign_of(d.y);
    }
    return {0.5f * x + 0.5f, 0.5f * y + 0.5f};
}

glm::vec3 direction_at(float s, float t) {
    glm::vec3 d(2.0f * s - 1.0f, 2.0f * t - 1.0f, 0.0f);
    d.z = 1.0f - std::abs(d.x) - std::abs(d.y);
    if (d.z < 0.0f) {
        const float x = d.x;
        d.x = (1.0f - std::abs(d.y)) * sign_of(x);
        d.y = (1.0f - std::abs(x)) * sign_of(d.y);
    }
    return glm::normalize(d);
}

Result<SeenMesh> SeenMesh::make(SurfaceMesh mesh) {
    TESSERA_TRY_ASSIGN(auto rays, RayScene::make(mesh.positions, mesh.triangles, true));
    return SeenMesh(std::move(mesh), std::move(rays));
}

std::optional<PhotoSample> SeenMesh::seen(const glm::dvec3& eye,
                                          const glm::dvec3& direction) const {
    const auto hit = rays_.first_hit(eye, direction);
    if (!hit)
        return std::nullopt;
    const SurfacePoint point = surface_point(mesh_, tangents_, hit->triangle, hit->barycentric);
    SurfaceFrame frame = point.frame;
    frame.ez = facing_normal(frame.ez, -direction);
    return sample_of(point.uv,
                     octahedral_place(AngularMap::octahedral_mirrored, frame, -direction));
}

std::string SeenMesh::unseen() const {
    return "no photograph sees the mesh: are the mesh and the cameras in the same units, with the "
           "same axis up?";
}

std::optional<PhotoSample> SeenSphere::seen(const glm::dvec3& eye,
                                            const glm::dvec3& direction) const {
    const glm::dvec3 from = eye - centre_;
    const double along = -glm::dot(from, direction);
    const double square = radius_ * radius_ - glm::dot(from, from) + along * along;
    const double distance = along - std::sqrt(std::max(square, 0.0));
    if (square < 0.0 || distance < 0.0)
        return std::nullopt;
    const auto st = place_of_direction(glm::vec3(-direction));
    return sample_of(sphere_place(from + distance * direction), {st[0], st[1]});
}

std::string SeenSphere::unseen() const {
    return "no photograph sees the sphere: are its centre and radius in the units of the cameras?";
}

std::optional<PhotoSample> SeenWindow::seen(const glm::dvec3& eye,
                                            const glm::dvec3& direction) const {
    const glm::dvec3 from = window_.local(eye), d = direction * window_.axes;
    if (!(from.z > 0.0) || !(d.z < -1e-9))
        return std::nullopt;
    const auto crossing = [&](double z) { return from + (z - from.z) / d.z * d; };
    const glm::dvec3 place = crossing(0.0), camera = crossing(window_.distance);
    const glm::dvec2 uv(place.x / window_.width + 0.5, 0.5 - place.y / window_.height);
    if (uv.x < 0.0 || uv.y < 0.0 || uv.x > 1.0 || uv.y > 1.0)
        return std::nullopt;
    // Rays beside the outermost cameras show what those see.
    const glm::dvec2 st(camera.x / (window_.spacing_x * window_.cameras[0]) + 0.5,
                        0.5 - camera.y / (window_.spacing_y * window_.cameras[1]));
    return sample_of(uv, glm::clamp(st, glm::dvec2(0.0), glm::dvec2(1.0)));
}

std::string SeenWindow::unseen() const {
    return "no photograph sees the window";
}

} // namespace tessera::corpus
