// Models with horizontal squares, and what an observer sees of a model.
#pragma once

#include "corpus/trace/tracer.h"
#include "tests/support/model_files.h"

namespace tessera::corpus::support {

// A square of side 2 * size at this height, seen from above or, `down`, from below.
inline void add_square(Model& model, float size, float height, bool down, std::uint32_t material) {
    const auto first = static_cast<std::uint32_t>(model.vertices.size());
    for (int i = 0; i < 4; ++i) {
        ModelVertex v;
        v.position = {i % 2 ? size : -size, height, i / 2 ? size : -size};
        v.normal = {0, down ? -1 : 1, 0};
        model.vertices.push_back(v);
    }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (down)
            std::swap(b, c);
        model.triangles.push_back({{first + a, first + b, first + c}, material});
    };
    add(0, 2, 1);
    add(1, 2, 3);
}

// A cube, whose triangles come first, on a floor whose sides are 400 times as long. The uv of the
// floor are its x and z.
inline const glm::vec3 cube_place{-1.2f, 0.0f, 1.3f};
inline constexpr float cube_side = 0.01f;

inline Model cube_on_floor() {
    Model model = cube_model();
    for (ModelVertex& v : model.vertices)
        v.position = 0.25f * cube_side * v.position + cube_place;
    const std::size_t first = model.vertices.size();
    add_square(model, 200.0f * cube_side, -0.5f * cube_side, false, 0);
    for (std::size_t i = first; i < model.vertices.size(); ++i) {
        const glm::vec3 p = model.vertices[i].position;
        model.vertices[i].uv = {glm::vec2(p.x, p.z), glm::vec2(0.0f)};
    }
    return model;
}

inline Tracer tracer_of(const Model& model, ModelLight light) {
    auto rays = RayModel::make(model);
    EXPECT_TRUE(rays.ok());
    return Tracer(std::move(*rays), std::move(light));
}

// The mean light that an observer at `eye` sees along `way`.
inline glm::dvec3 seen(const Tracer& tracer, const glm::dvec3& eye, const glm::dvec3& way,
                       unsigned count = 2048) {
    const auto hit = tracer.model().first_hit(eye, way);
    if (!hit)
        return tracer.light().environment->light(way);
    const LitPoint p = Tracer::facing(tracer.model().point(*hit), -way);
    glm::dvec3 sum(0.0);
    for (unsigned i = 0; i < count; ++i) {
        PathRandom random(4, i);
        sum += tracer.leaving(p, -way, random) / static_cast<double>(count);
    }
    return sum;
}

} // namespace tessera::corpus::support
