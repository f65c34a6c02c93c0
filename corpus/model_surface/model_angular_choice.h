// Which angular map shows a model best, by trial.
#pragma once

#include "corpus/model_surface/display.h"
#include "corpus/model_surface/lit_model.h"
#include "format/metadata.h"

namespace tessera::corpus {

// As choose_angular_map() of scenes. The paths of one place are those of all its directions and of its
// neighbours, so that noise is alike in what is compared.
AngularMap choose_angular_map(const LitModel& model, const Display& display,
                              const Texels2& directions);

} // namespace tessera::corpus
