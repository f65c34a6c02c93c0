// The environment as a few distant lights.
#pragma once

#include "corpus/trace/tracer.h"
#include "format/layers.h"

namespace tessera::corpus {

// At most `count` lights with the total light of the environment. Its picture is split at the place
// that reduces the lights' spread most, weighted by brightness, until there are enough lights.
// Neighbouring lights in the list are close to each other. The sun, if there is one, is one more
// light without spread; so is each directional lamp. `exposure` multiplies all light.
std::vector<DistantLight> distant_lights(const ModelLight& light, unsigned count, double exposure);

} // namespace tessera::corpus
