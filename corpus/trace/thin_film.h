// Interference in a thin film (KHR_materials_iridescence).
#pragma once

#include <glm/vec3.hpp>

namespace tessera::corpus {

// The reflectance, in linear sRGB, of a film in air above a base that mirrors `base` at normal
// incidence in air. `cosine` is that of the angle in air. Values are within 0..1. By Belcour and
// Barla, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence"
// (2017), with the simplifications of the Khronos glTF Sample Viewer (iridescence.glsl): Schlick's
// approximation at both interfaces and two orders of interference.
glm::dvec3 film_reflectance(double cosine, double film_ior, double nanometres,
                            const glm::dvec3& base);

} // namespace tessera::corpus
