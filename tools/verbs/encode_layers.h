// Encodes the baked layers of a model and joins them to one file.
#pragma once

#include "codec/encoder.h"
#include "corpus/layers/model_layers.h"
#include "tools/support/json_text.h"

#include <cstdio>
#include <optional>

namespace tessera {

struct CodedLayer {
    const corpus::LayerTexture* texture = nullptr;
    std::vector<std::byte> bytes;
    double psnr = 0; // dB over the texels that are not masked
};

struct CodedLayers {
    std::vector<CodedLayer> layers; // in the order of the file
    std::vector<std::byte> file;    // of all of them
    double quality = 0;
};

// Encodes at `quality`, or, if `most_bytes` is given, at the best quality with which the file has at
// most so many bytes. `options` are those of all layers: effort, threads, metadata, mesh. Errors:
// bad_argument, if even the worst quality takes more bytes; those of encode_memory().
Result<CodedLayers> encode_layers(const corpus::ModelLayers& baked, const EncodeOptions& options,
                                  std::optional<double> quality,
                                  std::optional<std::uint64_t> most_bytes);

// The layers as a list of {"role", "size", "bytes", "psnr"}. `bytes` of the first one count the mesh.
Json layers_json(const CodedLayers& coded);
// A line for the mesh and one for each layer.
void print_layers(std::FILE* to, const corpus::ModelLayers& baked, const CodedLayers& coded);

} // namespace tessera
