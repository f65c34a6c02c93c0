// Encodes layers that are baked, writes the file and reports it.
#pragma once

#include "corpus/layers/model_layers.h"
#include "tools/verbs/bake_sources.h"

#include <chrono>

namespace tessera {

struct BakedLayers {
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    corpus::ModelLayers layers;
    double density = 0;                                     // texels per unit of the user
    std::vector<std::pair<std::string, std::string>> facts; // as Baking has them
    Json json;                                              // more figures, for --json
    std::string remark;                                     // one line for people
};

corpus::BakeRun bake_run(const BakeCommand& a, ProgressFunction progress);

// Errors: those of encode_layers() and write_baked_glb(); io.
Status write_layers(const BakeCommand& a, const BakedLayers& baked, const Warnings& warnings);

} // namespace tessera
