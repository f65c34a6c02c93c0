#include "tools/view/layer_files.h"

#include "tools/support/parse.h"

namespace tessera {

Result<std::vector<OpenLayerFile>> open_layers(ByteSource& file, const ContainerReader& first,
                                               const DecodeOptions& options) {
    const Layers& layers = first.layers();
    if (layers.any())
        TESSERA_TRY(
            check_layer(LayerRole::diffuse, first.desc(), first.description(), layers.lights.size())
                .with_context(first.name()));
    TESSERA_TRY_ASSIGN(auto sources, bytes_of_layers(file, layers));
    std::vector<OpenLayerFile> open;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const LayerInfo& info = layers.further[i];
        OpenLayerFile layer{info, std::move(sources[i]), nullptr};
        TESSERA_TRY_ASSIGN(Decoder decoder, Decoder::open(*layer.bytes, options));
        layer.decoder = std::make_unique<Decoder>(std::move(decoder));
        const ContainerReader& container = layer.decoder->container();
        if (container.layers().any())
            return Status(ErrorCode::invalid_file, container.name() + ": has layers of its own");
        TESSERA_TRY(
            check_layer(info.role, container.desc(), container.description(), layers.lights.size())
                .with_context(container.name()));
        open.push_back(std::move(layer));
    }
    return open;
}

Result<std::unique_ptr<ByteSource>> find_layer(ByteSource& file, const ContainerReader& first,
                                               const std::string& role) {
    if (!first.layers().any())
        return Status(ErrorCode::bad_argument, first.name() + ": has no layers");
    std::string roles = name_of(LayerRole::diffuse);
    if (role == roles)
        return std::unique_ptr<ByteSource>();
    for (const LayerInfo& info : first.layers().further) {
        if (role == name_of(info.role))
            return layer_bytes(file, info);
        roles += std::string(", ") + name_of(info.role);
    }
    return Status(ErrorCode::bad_argument,
                  first.name() + ": has no layer '" + printable(role) + "', but " + roles);
}

} // namespace tessera
