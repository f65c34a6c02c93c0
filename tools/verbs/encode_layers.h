// Encodes the baked layers of a model and joins them to one file.
#pragma once

#include "codec/encoder.h"
#include "corpus/layers/model_layers.h"
#include "tools/support/encode_arguments.h"
#include "tools/support/json_text.h"

#include <cstdio>
#include <optional>

namespace tessera {

inline constexpr double lossless_psnr = 999;

struct CodedLayer {
    const corpus::LayerTexture* texture = nullptr;
    std::vector<std::byte> bytes;
    double psnr = 0; // dB over the texels that are not masked
};

struct CodedLayers {
    std::vector<CodedLayer> layers; // in the order of the file
    std::vector<std::byte> file;    // of all of them
    std::optional<double> quality;  // none: coded with a largest error
    // Of layers that add up, those of a fit: dB of their sum over texels, if the errors of the
    // layers have nothing to do with each other. lossless_psnr: they have none.
    double sum_psnr = 0;
};

// At most one is set; otherwise the quality is the usual one.
struct LayerRate {
    std::optional<double> quality = {};
    std::optional<std::uint64_t> most_bytes = {}; // of the file
    std::optional<double> most_bits = {};         // of the file per texel of all layers
    std::optional<double> least_psnr = {};        // CodedLayers::sum_psnr
    std::optional<double> most_error = {};        // of a sample of a layer; 0: lossless
};
LayerRate rate_of_layers(const EncodeArguments& arguments);

// Encodes with the best quality that keeps to `most_bytes` or `most_bits`, or the least one that
// reaches `least_psnr`. If no quality reaches that, the layers are lossless if that is smaller than the
// best quality, or if options.lossless_fallback is set. `options` are those of all layers: effort, threads, metadata, mesh. Errors: bad_argument (even
// the worst quality takes more bytes); target_missed; those of encode_memory().
Result<CodedLayers> encode_layers(const corpus::ModelLayers& baked, const EncodeOptions& options,
                                  const LayerRate& rate);

// "quality 58.0", "largest error 2" or "lossless".
std::string rate_text(const CodedLayers& coded);

// The layers as a list of {"role", "size", "bytes", "psnr"}. `bytes` of the first one count the mesh.
Json layers_json(const CodedLayers& coded);
// A line for the mesh and one for each layer.
void print_layers(std::FILE* to, const corpus::ModelLayers& baked, const CodedLayers& coded);

} // namespace tessera
