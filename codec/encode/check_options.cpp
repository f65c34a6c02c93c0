// check_options(): what can be refused before a texel is read.
#include "codec/encoder.h"

#include "codec/decoder.h"
#include "codec/texels/texel_mask.h"
#include "codec/trials/tile_shapes.h"
#include "format/container/container_writer.h"
#include "format/container/syntax.h"
#include "format/surface_mesh.h"
#include "format/tile/coding_parameters.h"
#include "format/tile/limits.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string_view>

namespace tessera {
namespace {

Status refused(const std::string& what) {
    return {ErrorCode::bad_argument, what};
}

std::string text_of(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

Status check_tile(const EncodeOptions& options) {
    if (options.tile_extent == tile_by_trial)
        return {};
    for (std::size_t axis = 0; axis < 4; ++axis) {
        const std::uint32_t side = options.tile_extent[axis];
        if (side < 1 || side > static_cast<std::uint32_t>(max_side_along(axis)))
            return refused("tile sides must be 1 to 256 along u and v, 1 to 32 along s and t");
    }
    const bool corrects = options.rate.kind == RateTarget::Kind::max_error;
    const int most_texels = max_texels_of_tile(corrects);
    if (texel_count(options.tile_extent) > static_cast<std::uint64_t>(most_texels))
        return refused("a tile of " + to_string(options.tile_extent) + " has more than " +
                       std::to_string(most_texels) + " texels" +
                       (corrects ? ", the most with a maximum error" : ""));
    return {};
}

std::vector<Extent4> possible_tiles(const TextureDesc& desc, const EncodeOptions& options) {
    if (options.tile_extent != tile_by_trial)
        return {options.tile_extent};
    return tile_shapes(desc.size, options).tiles;
}

Status check_tile_count(const TextureDesc& desc, const EncodeOptions& options) {
    const std::vector<Extent4> tiles = possible_tiles(desc, options);
    if (TileGrid(desc.size, tiles.front()).tiles() > max_tiles)
        return {ErrorCode::unsupported, "more than 2^32 - 1 tiles"};
    return {};
}

Status check_rate(const RateTarget& rate, SampleType type) {
    using Kind = RateTarget::Kind;
    const double value = rate.value;
    const std::int32_t largest_error = traits_of(type).largest_error;
    if (!std::isfinite(value))
        return refused("the rate target is not a number");
    switch (rate.kind) {
    case Kind::quality:
        return value >= 1 && value <= 100 ? Status() : refused("quality must be 1 to 100");
    case Kind::psnr:
        return value > 0 && value <= 120 ? Status()
                                         : refused("target PSNR must be above 0, at most 120 dB");
    case Kind::max_error:
        return value >= 0 && value <= largest_error && value == std::floor(value)
                   ? Status()
                   : refused("maximum error must be a whole number from 0 to " +
                             std::to_string(largest_error));
    case Kind::bpt:
    case Kind::bytes:
        return value > 0 ? Status() : refused("the size target must be above 0");
    }
    return refused("unknown kind of rate target");
}

// The caller may have cast any number to an enumeration.
template <NamedEnum Enum> Status check_known(Enum value, const char* name) {
    return is_known(value) ? Status()
                           : refused(std::string(name) + " " +
                                     std::to_string(static_cast<unsigned>(value)) + " is unknown");
}

Status check_description(const TextureDesc& desc, const Description& d) {
    TESSERA_TRY(check_known(d.proxy, "proxy"));
    TESSERA_TRY(check_known(d.surface_map, "surface map"));
    TESSERA_TRY(check_known(d.angular_map, "angular map"));
    TESSERA_TRY(check_known(d.transfer, "transfer"));
    TESSERA_TRY(check_known(d.primaries, "primaries"));
    TESSERA_TRY(check_known(d.alpha, "alpha"));
    // The rules are those of a file's header, but the caller knows of no header field.
    FileHeader header;
    header.desc = desc;
    header.section_count = min_sections;
    header.description = d;
    Status status = check_fields(header);
    if (status)
        status = check_geometry(d);
    std::string_view message = status.message();
    constexpr std::string_view prefix = "header field ";
    if (message.starts_with(prefix))
        message.remove_prefix(prefix.size());
    return status.ok() ? Status() : refused(std::string(message));
}

Status check_surface(const EncodeOptions& options) {
    const bool mesh = options.description.proxy == Proxy::mesh;
    if (mesh != !options.mesh.empty())
        return refused(mesh ? "the proxy is a mesh, but no mesh is given"
                            : "a mesh is given, but the proxy is not a mesh");
    if (!mesh)
        return {};
    const Status status =
        decode_mesh(options.mesh, std::numeric_limits<std::uint64_t>::max()).status();
    return status.ok() ? Status() : refused(status.message());
}

// The size of a file with background tiles only and with built-in tables: no file of this texture is
// smaller.
Result<std::uint64_t> least_file_bytes(const TextureDesc& desc, const EncodeOptions& options) {
    const std::vector<std::byte> coding = write_coding_parameters({}, desc.channels, false);
    ContainerContents contents;
    contents.desc = desc;
    contents.description = options.description;
    contents.metadata = options.metadata;
    contents.codec_parameters = coding;
    contents.proxy_mesh = options.mesh;
    contents.tile_length = [](std::uint64_t) { return std::uint64_t{0}; };
    contents.tile = [](std::uint64_t) { return std::span<const std::byte>(); };
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (const Extent4& tile : possible_tiles(desc, options)) {
        if (TileGrid(desc.size, tile).tiles() > max_tiles)
            continue; // the encoder cannot choose it
        contents.tile_extent = tile;
        TESSERA_TRY_ASSIGN(const std::uint64_t bytes, container_bytes(contents));
        least = std::min(least, bytes);
    }
    return least;
}

Status check_size_target(const TextureDesc& desc, const EncodeOptions& options) {
    using Kind = RateTarget::Kind;
    const RateTarget& rate = options.rate;
    if (rate.kind != Kind::bytes && rate.kind != Kind::bpt)
        return {};
    const auto texels = static_cast<double>(texel_count(desc.size));
    const double wanted = rate.kind == Kind::bytes ? rate.value : rate.value * texels / 8;
    TESSERA_TRY_ASSIGN(const std::uint64_t least, least_file_bytes(desc, options));
    if (wanted >= static_cast<double>(least))
        return {};
    return refused("the target cannot be met: it is " + text_of(std::floor(wanted)) +
                   " bytes, but no file of this texture is smaller than " + std::to_string(least));
}

Status check_reuse(const TextureDesc& desc, const EncodeOptions& options) {
    if (options.reuse == nullptr)
        return {};
    const ContainerReader& file = options.reuse->container();
    const TextureDesc& other = file.desc();
    const auto text_of_desc = [](const TextureDesc& d) {
        return to_string(d.size) + ", " + std::to_string(d.channels) + " x " +
               traits_of(d.type).name;
    };
    if (other.size != desc.size || other.type != desc.type || other.channels != desc.channels)
        return refused("the file to reuse holds another texture: " + text_of_desc(other) +
                       ", not " + text_of_desc(desc))
            .with_context(file.name());
    if (file.is_partial())
        return refused("the file to reuse is incomplete").with_context(file.name());
    if (file.alignment().any() && (options.layers || options.description.proxy != Proxy::none))
        return refused(
                   "the file to reuse has aligned views, which exclude coarse levels and surfaces")
            .with_context(file.name());
    return {};
}

} // namespace

Status check_options(const TextureDesc& desc, const EncodeOptions& options) {
    TESSERA_TRY(check_desc(desc));
    TESSERA_TRY(check_mask(options.mask, desc.size));
    if (options.effort < 0 || options.effort > most_effort)
        return refused("effort must be 0 to " + std::to_string(most_effort));
    TESSERA_TRY(check_tile(options));
    TESSERA_TRY(check_tile_count(desc, options));
    TESSERA_TRY(check_rate(options.rate, desc.type));
    TESSERA_TRY(check_description(desc, options.description));
    TESSERA_TRY(check_surface(options));
    TESSERA_TRY(check_metadata(options.metadata));
    TESSERA_TRY(check_reuse(desc, options));
    return check_size_target(desc, options);
}

} // namespace tessera
