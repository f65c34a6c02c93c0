// How the lobes of a place reflect light, and how to sample them. Besides the lobes of lobes.h there
// are those of glTF's extensions:
//
// A clear coat is a mirror of its own above the others: GGX with Schlick's Fresnel term for an index
// of 1.5. Sheen is described in sheen.h. Both take light from the lobes below. glTF takes what a
// view sees of them from all light, which makes the sum depend on which way light goes. Here the
// specular lobe loses what the coat's facet reflects, or the larger of what the sheen takes at both
// directions. The diffuse lobe loses a factor of each direction, divided by the mean factor. Its
// albedo is that of glTF's formula, and diffuse light is still baked once per place.
#pragma once

#include "corpus/trace/lit_point.h"
#include "corpus/trace/path_random.h"

namespace tessera::corpus {

// A lobe times the cosine of the light and the opacity, and the density with which the lobe samples the direction.
struct Thrown {
    glm::dvec3 share{0.0};
    double density = 0;
};

// The diffuse lobe without its factor of the view, which is below_coats(). sample_cosine() samples
// it.
struct DiffuseLobe {
    const LitPoint& p;
    Thrown operator()(const glm::dvec3& l) const;
    static double width() { return 1.0; } // as the alpha of GGX
};
// The share of light that coats leave to what is below them, in this direction, which is above the
// normal.
double below_coats(const LitPoint& p, const glm::dvec3& direction);
// Its mean over the directions of diffuse light.
double mean_below_coats(const Coats& coats);

// All lobes but the diffuse one: what a place reflects and does not scatter.
struct SpecularLobe {
    const LitPoint& p;
    glm::dvec3 view;
    Thrown operator()(const glm::dvec3& l) const;
    // May point into the surface.
    glm::dvec3 sample(PathRandom& random) const;
    // About the share of light that the lobe reflects, 0..1.
    double strength() const;
    double width() const; // the largest alpha of GGX
};

// Diffuse and specular lobe. The specular one samples the share `specular_share` of the directions.
struct BothLobes {
    DiffuseLobe diffuse;
    SpecularLobe specular;
    double specular_share;
    BothLobes(const LitPoint& p, const glm::dvec3& view);
    Thrown operator()(const glm::dvec3& l) const;
    glm::dvec3 sample(PathRandom& random) const;
    double width() const; // of the widest lobe, as the alpha of GGX
};

// The nearest lobes without coats, for layers, which have one specular lobe per place. Sheen joins
// the diffuse lobe, a clear coat the specular one with the mean roughness; highlights are equally
// long in all directions, and a film has one colour. Nothing passes.
Lobes without_coats(const Lobes& lobes);

} // namespace tessera::corpus
