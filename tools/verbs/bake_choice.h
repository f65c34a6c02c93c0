// Whether `tessera bake` makes layers or one texture of a model.
#pragma once

#include "tools/verbs/bake_sources.h"

namespace tessera {

struct BakeChoice {
    bool layered = true;
    std::string why; // the end of a sentence that begins with what was chosen
    // Rough estimates, for people: the time on this machine and the length of the file. 0: unknown.
    double seconds = 0, bytes = 0;
};

// The first option that only one texture can honour, as it is typed; empty: none.
std::string option_of_one_texture(const BakeCommand& a);

// The first option that only layers of a model can honour, as it is typed; empty: none.
std::string option_of_model_layers(const BakeCommand& a);

// Follows --layered, --single and other options that only one of both can honour, else a trial with
// a few paths. Errors: those of corpus::try_layers().
Result<BakeChoice> choose_layers(const BakeCommand& a, const ModelToBake& model);

// Whether the command reports its choice.
bool speaks(const BakeCommand& a);

// How many threads it will use.
unsigned threads_of(const BakeCommand& a);

// One line on standard error, unless the command is quiet or prints JSON.
void say_choice(const BakeCommand& a, const BakeChoice& choice);

} // namespace tessera
