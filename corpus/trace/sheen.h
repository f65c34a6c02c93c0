// The sheen of cloth (KHR_materials_sheen): Charlie's distribution with its shadowing, by Estevez
// and Kulla, "Production Friendly Microfacet Sheen BRDF" (2017).
#pragma once

namespace tessera::corpus {

// Sheen with a lower alpha would reflect more light than it receives at grazing angles.
constexpr double least_sheen_alpha = 0.04;

// The sheen of white cloth, per steradian, for the cosines of the half vector, the light and the
// view to the normal. `alpha` is at least least_sheen_alpha.
double sheen_lobe(double alpha, double nh, double nl, double nv);

// The share of light that this lobe reflects towards the view, 0..1, from a table that the first
// call integrates; and its mean over all directions of diffuse light. Thread-safe.
double sheen_albedo(double alpha, double nv);
double mean_sheen_albedo(double alpha);

} // namespace tessera::corpus
