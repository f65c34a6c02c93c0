#include "tools/verbs/encode_layers.h"

#include "tools/support/parse.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace tessera {
namespace {

constexpr double usual_layer_quality = 58;
constexpr double least_quality = 1, most_quality = 100;
constexpr int quality_steps = 6; // of the search, each halves the range

// The quality of a layer, so that all layers save about the same error per byte (FlightHelmet).
double quality_of(LayerRole role, double quality) {
    constexpr std::array<double, value_names<LayerRole>.size()> changes{4, 4,  0,  -8, 3, -3,
                                                                        0, -4, 16, 0,  0, 0};
    return std::clamp(quality + changes[static_cast<std::size_t>(role)], least_quality,
                      most_quality);
}

Result<CodedLayer> encode_layer(const corpus::LayerTexture& texture, EncodeOptions options,
                                double quality) {
    options.rate = {RateTarget::Kind::quality,
                    quality_of(texture.role, quality + texture.quality_change)};
    MemorySource source(texture.desc, texture.texels), mask(texture.mask_desc, texture.mask);
    options.mask = &mask;
    options.tile_extent = texture.tile;
    options.description.transfer = texture.transfer;
    options.description.surface_map = SurfaceMap::mesh_uv;
    options.description.angular_map =
        texture.role == LayerRole::visibility ? AngularMap::none : AngularMap::octahedral_mirrored;
    if (texture.role == LayerRole::diffuse) {
        options.description.proxy = Proxy::mesh;
        options.description.primaries = Primaries::bt709;
    } else {
        options.mesh.clear();
        options.metadata.clear();
    }
    CodedLayer coded{&texture, {}, 0};
    TESSERA_TRY_ASSIGN(const EncodeReport report, encode_memory(source, coded.bytes, options));
    coded.psnr = report.psnr;
    return coded;
}

Result<CodedLayers> encode_at(const corpus::ModelLayers& baked, const EncodeOptions& options,
                              double quality) {
    CodedLayers coded;
    coded.quality = quality;
    for (const corpus::LayerTexture& texture : baked.layers) {
        TESSERA_TRY_ASSIGN(CodedLayer layer, encode_layer(texture, options, quality));
        coded.layers.push_back(std::move(layer));
    }
    const auto scale = [](const CodedLayer& layer) {
        return static_cast<float>(layer.texture->scale);
    };
    std::vector<LayerFile> further;
    for (std::size_t i = 1; i < coded.layers.size(); ++i)
        further.push_back(
            {coded.layers[i].texture->role, scale(coded.layers[i]), coded.layers[i].bytes});
    TESSERA_TRY_ASSIGN(coded.file, join_layers(coded.layers[0].bytes, scale(coded.layers[0]),
                                               further, baked.lights));
    return coded;
}

} // namespace

Result<CodedLayers> encode_layers(const corpus::ModelLayers& baked, const EncodeOptions& options,
                                  std::optional<double> quality,
                                  std::optional<std::uint64_t> most_bytes) {
    if (!most_bytes)
        return encode_at(baked, options, quality.value_or(usual_layer_quality));
    double low = least_quality, high = most_quality;
    TESSERA_TRY_ASSIGN(CodedLayers best, encode_at(baked, options, low));
    if (best.file.size() > *most_bytes)
        return Status(ErrorCode::bad_argument, "--target-bytes " + std::to_string(*most_bytes) +
                                                   ": even at the lowest quality the layers take " +
                                                   std::to_string(best.file.size()) +
                                                   " bytes, of which " +
                                                   std::to_string(baked.mesh.size()) +
                                                   " are the mesh; --texels makes fewer texels");
    for (int i = 0; i < quality_steps; ++i) {
        const double middle = (low + high) / 2;
        TESSERA_TRY_ASSIGN(CodedLayers tried, encode_at(baked, options, middle));
        const bool fits = tried.file.size() <= *most_bytes;
        (fits ? low : high) = middle;
        if (fits)
            best = std::move(tried);
    }
    return best;
}

Json layers_json(const CodedLayers& coded) {
    Json layers = Json::array();
    for (const CodedLayer& layer : coded.layers)
        layers.push_back({{"role", name_of(layer.texture->role)},
                          {"size", to_string(layer.texture->desc.size)},
                          {"bytes", layer.bytes.size()},
                          {"psnr", layer.psnr}});
    return layers;
}

void print_layers(std::FILE* to, const corpus::ModelLayers& baked, const CodedLayers& coded) {
    std::size_t width = 11;
    for (const CodedLayer& layer : coded.layers)
        width = std::max(width, std::string_view(name_of(layer.texture->role)).size());
    const int column = static_cast<int>(width);
    std::fprintf(to, "  %-*s %s: %zu triangles, %zu charts\n", column, "mesh",
                 human_bytes(baked.mesh.size()).c_str(), baked.decoded_mesh.triangles.size(),
                 baked.charts);
    for (const CodedLayer& layer : coded.layers) {
        const bool first = layer.texture->role == LayerRole::diffuse;
        const std::size_t own = layer.bytes.size() - (first ? baked.mesh.size() : 0);
        std::fprintf(to, "  %-*s %s: %s\n", column, name_of(layer.texture->role),
                     human_bytes(own).c_str(), to_string(layer.texture->desc.size).c_str());
    }
}

} // namespace tessera
