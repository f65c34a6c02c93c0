// Reads the material of a model at a place.
#pragma once

#include "corpus/model/model.h"
#include "corpus/trace/lit_point.h"

namespace tessera::corpus {

// The values of a triangle's corners, interpolated.
struct Interpolated {
    glm::dvec3 position, normal;
    glm::dvec4 tangent, colour;
    std::array<glm::dvec2, 2> uv;
};
Interpolated interpolated_at(const Model& model, const ModelPlace& place);

LitPoint lit_point(const Model& model, const ModelPlace& place);
// Its emission alone.
glm::dvec3 emission_at(const Model& model, const ModelMaterial& m, const Interpolated& at);
// The alpha of the base colour.
double alpha_at(const Model& model, const ModelMaterial& m, const Interpolated& at);
// LitPoint::opacity.
double opacity_at(const Model& model, const ModelMaterial& m, const Interpolated& at);

} // namespace tessera::corpus
