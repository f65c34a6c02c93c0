#include "tools/verbs/encode_layers.h"

#include "tools/support/parse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace tessera {
namespace {

constexpr double usual_layer_quality = 58;
constexpr double least_quality = 1, most_quality = 100;
constexpr int size_steps = 7, most_size_steps = 12, psnr_steps = 8; // of the searches

// The quality of a layer, so that all layers save about the same error per byte (FlightHelmet).
double quality_of(LayerRole role, double quality) {
    constexpr std::array<double, value_names<LayerRole>.size()> changes{4, 4,  0,  -8, 3, -9,
                                                                        0, -4, 16, 0,  0, 0};
    return std::clamp(quality + changes[static_cast<std::size_t>(role)], least_quality,
                      most_quality);
}

// A quality, or the largest error of all layers.
struct TriedRate {
    double quality = 0;
    std::optional<double> most_error{};
};

Result<CodedLayer> encode_layer(const corpus::LayerTexture& texture, EncodeOptions options,
                                const TriedRate& rate) {
    options.rate =
        rate.most_error
            ? RateTarget{RateTarget::Kind::max_error, *rate.most_error}
            : RateTarget{RateTarget::Kind::quality,
                         quality_of(texture.role, rate.quality + texture.quality_change)};
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

// See CodedLayers::sum_psnr.
double psnr_of_sum(std::span<const CodedLayer> layers) {
    double error = 0; // squared, of values of 0..1
    for (const CodedLayer& layer : layers) {
        if (layer.psnr >= lossless_psnr)
            continue;
        // What a step of a sample changes; see signed_value().
        const double size =
            layer.texture->scale * (is_signed(layer.texture->role) ? 255.0 / 127.0 : 1.0);
        error += size * size * std::pow(10.0, -layer.psnr / 10.0);
    }
    return error > 0 ? -10.0 * std::log10(error) : lossless_psnr;
}

Result<CodedLayers> encode_at(const corpus::ModelLayers& baked, const EncodeOptions& options,
                              const TriedRate& rate) {
    CodedLayers coded;
    if (!rate.most_error)
        coded.quality = rate.quality;
    for (const corpus::LayerTexture& texture : baked.layers) {
        TESSERA_TRY_ASSIGN(CodedLayer layer, encode_layer(texture, options, rate));
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
    coded.sum_psnr = psnr_of_sum(coded.layers);
    return coded;
}

// A file of this quality, and the logarithm of its bytes without the mesh, which grows almost
// linearly.
struct TriedSize {
    double quality = 0, log_bytes = 0;
};

// The quality to try next for a file of so many bytes. Nothing if there is none left to try.
std::optional<double> next_quality(const std::optional<TriedSize>& fits,
                                   const std::optional<TriedSize>& exceeds, double log_bytes) {
    constexpr double usual_slope = 0.045; // of log_bytes
    constexpr double least_step = 0.02;
    const double low = fits ? fits->quality + least_step : least_quality,
                 high = exceeds ? exceeds->quality - least_step : most_quality;
    if (low > high)
        return std::nullopt;
    const TriedSize& from = fits ? *fits : *exceeds;
    const double slope = fits && exceeds ? (exceeds->log_bytes - fits->log_bytes) /
                                               (exceeds->quality - fits->quality)
                                         : usual_slope;
    return std::clamp(from.quality + (log_bytes - from.log_bytes) / std::max(slope, 1e-3), low,
                      high);
}

// The best quality with which the file has at most so many bytes, to half a per cent of them.
Result<CodedLayers> encode_in(const corpus::ModelLayers& baked, const EncodeOptions& options,
                              std::uint64_t most_bytes, const std::string& option) {
    constexpr double close_enough = 0.995, too_small = 0.9;
    const auto most = static_cast<double>(most_bytes);
    const auto log_of = [&](double bytes) { // the mesh does not depend on the quality
        return std::log(std::max(bytes - static_cast<double>(baked.mesh.size()), 1.0));
    };
    const double wanted = log_of(most * (1.0 + close_enough) / 2.0);
    std::optional<CodedLayers> best;
    std::optional<TriedSize> fits, exceeds;
    std::optional<double> quality = usual_layer_quality;
    bool was_small = false;
    int in_a_row = 0; // tries that were all too large, or all not
    const auto goes_on = [&](int i) {
        return i < size_steps ||
               (i < most_size_steps &&
                (!best || static_cast<double>(best->file.size()) < too_small * most));
    };
    for (int i = 0; quality && goes_on(i); ++i) {
        TESSERA_TRY_ASSIGN(CodedLayers tried, encode_at(baked, options, {*quality}));
        const auto bytes = static_cast<double>(tried.file.size());
        const bool is_small = bytes <= most;
        (is_small ? fits : exceeds) = {*quality, log_of(bytes)};
        if (is_small)
            best = std::move(tried);
        if ((is_small && (bytes >= close_enough * most || *quality == most_quality)) ||
            (!is_small && *quality == least_quality))
            break;
        // Where the logarithm is curved, secants come near from one side, ever more slowly. The
        // Illinois method halves the value of the other side.
        in_a_row = is_small == was_small ? in_a_row + 1 : 1;
        was_small = is_small;
        if (auto& other = is_small ? exceeds : fits; other && in_a_row > 1)
            other->log_bytes = 0.5 * (other->log_bytes + wanted);
        quality = next_quality(fits, exceeds, wanted);
    }
    if (best)
        return std::move(*best);
    TESSERA_TRY_ASSIGN(CodedLayers least, encode_at(baked, options, {least_quality}));
    if (least.file.size() <= most_bytes)
        return least;
    return Status(ErrorCode::bad_argument,
                  option + ": even at the lowest quality the layers take " +
                      std::to_string(least.file.size()) + " bytes, of which " +
                      std::to_string(baked.mesh.size()) +
                      " are the mesh; --texels makes fewer texels");
}

// The least quality whose sum_psnr is at least `psnr`.
Result<CodedLayers> encode_with_psnr(const corpus::ModelLayers& baked, const EncodeOptions& options,
                                     double psnr) {
    double low = least_quality, high = most_quality;
    TESSERA_TRY_ASSIGN(CodedLayers best, encode_at(baked, options, {high}));
    if (best.sum_psnr < psnr) {
        TESSERA_TRY_ASSIGN(CodedLayers lossless, encode_at(baked, options, {0, 0.0}));
        if (options.lossless_fallback || lossless.file.size() < best.file.size())
            return lossless;
        return Status(ErrorCode::target_missed,
                      "the layers have at most " + format_number(best.sum_psnr, 2) + " dB, not " +
                          format_number(psnr, 2) + "; --lossless-fallback writes a lossless file");
    }
    for (int i = 0; i < psnr_steps; ++i) {
        const double middle = (low + high) / 2;
        TESSERA_TRY_ASSIGN(CodedLayers tried, encode_at(baked, options, {middle}));
        const bool reaches = tried.sum_psnr >= psnr;
        (reaches ? high : low) = middle;
        if (reaches)
            best = std::move(tried);
    }
    return best;
}

} // namespace

LayerRate rate_of_layers(const EncodeArguments& a) {
    LayerRate rate{a.quality, a.target_bytes, a.target_bpt, a.target_psnr, a.max_error};
    if (a.lossless)
        rate.most_error = 0;
    return rate;
}

Result<CodedLayers> encode_layers(const corpus::ModelLayers& baked, const EncodeOptions& options,
                                  const LayerRate& rate) {
    if (rate.most_bytes)
        return encode_in(baked, options, *rate.most_bytes,
                         "--target-bytes " + std::to_string(*rate.most_bytes));
    if (rate.most_bits) {
        double bytes = 0;
        for (const corpus::LayerTexture& texture : baked.layers)
            bytes += *rate.most_bits / 8.0 * static_cast<double>(texel_count(texture.desc.size));
        return encode_in(baked, options, static_cast<std::uint64_t>(bytes),
                         "--target-bpt " + format_number(*rate.most_bits, 4));
    }
    if (rate.least_psnr)
        return encode_with_psnr(baked, options, *rate.least_psnr);
    return encode_at(baked, options, {rate.quality.value_or(usual_layer_quality), rate.most_error});
}

std::string rate_text(const CodedLayers& coded) {
    if (coded.quality)
        return "quality " + format_number(*coded.quality, 1);
    return coded.sum_psnr >= lossless_psnr ? "lossless" : "with a largest error";
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
