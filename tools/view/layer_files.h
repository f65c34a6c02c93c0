// The layers of a file, each opened as a file of its own.
#pragma once

#include "codec/decoder.h"
#include "format/layers.h"

#include <memory>
#include <string>
#include <vector>

namespace tessera {

struct OpenLayerFile {
    LayerInfo info;
    std::unique_ptr<ByteSource> bytes;
    std::unique_ptr<Decoder> decoder; // of `bytes`
};

// Opens the layers besides the first one. `file` is what `first` was opened from, and outlives the
// result. Errors: those of Decoder::open() and check_layer(), with the layer's name.
Result<std::vector<OpenLayerFile>> open_layers(ByteSource& file, const ContainerReader& first,
                                               const DecodeOptions& options);

// The bytes of the layer of that role as a file of its own; null for the first layer, which is the
// file itself. `file` is what `first` was opened from, and outlives the result. Error: bad_argument,
// which lists the roles of the file.
Result<std::unique_ptr<ByteSource>> find_layer(ByteSource& file, const ContainerReader& first,
                                               const std::string& role);

} // namespace tessera
