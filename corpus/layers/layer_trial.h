// A quick test of how well layers can show a model.
#pragma once

#include "corpus/model_surface/display.h"
#include "corpus/trace/tracer.h"

namespace tessera::corpus {

// Layers blur what a smooth surface mirrors of the model itself, and lack the highlights of lamps
// that are not directional.
struct LayerTrial {
    // PSNR of what layers can show at some places of the surface, seen from outside: all light but
    // what they blur or lack, beside all light. 100 if they lose nothing.
    double decibels = 100;
    std::uint64_t paths = 0; // that were traced
};

// `model` comes from with_both_sides(). The result depends on the arguments only. Errors: those of
// RayModel::make().
Result<LayerTrial> try_layers(Model model, const ModelLight& light, const Display& display);

} // namespace tessera::corpus
