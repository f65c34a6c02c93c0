#include "codec/pass/tile_reuse.h"

#include "codec/decoder.h"
#include "format/container/file_coding.h"
#include "format/tile/features.h"

#include <algorithm>

namespace tessera {
namespace {

bool has_feature(const ContainerReader& file, std::uint64_t feature) {
    return (file.header().required_features & feature) != 0;
}

} // namespace

Result<CodingParameters> plan_reuse(const Decoder& file, EncodePlan& plan) {
    const ContainerReader& container = file.container();
    const FileHeader& header = container.header();
    plan.reused = &file;
    plan.grid = container.grid();
    plan.colour.transform = header.colour;
    plan.colour.background = header.background;
    plan.colour.corrections = has_feature(container, feature_corrections);
    // The kept tiles need the tables that they were coded with.
    plan.effort.recode = false;
    if (header.colour != ColourTransform::ycocg_r) // rotations are defined on YCoCg
        plan.effort.rotate_colours = plan.effort.search.rotated_colours = false;
    return coding_of(container).with_context(container.name());
}

Result<bool> load_reusable_tile(const EncodePlan& plan, std::uint64_t number,
                                std::vector<std::byte>& payload) {
    const ContainerReader& container = plan.reused->container();
    TESSERA_TRY(
        container.read_tile_checked(number, payload).with_context(about_reused_tile(plan, number)));
    // A payload as long as the texels is a stored tile in files that have any.
    return has_feature(container, feature_stored) ||
           payload.size() != plan.colour.desc.box_bytes(plan.grid.box(number));
}

bool is_mostly_kept(std::span<const std::byte> texels, std::span<const std::byte> decoded,
                    std::size_t texel_bytes) {
    std::size_t kept = 0;
    for (std::size_t at = 0; at < texels.size(); at += texel_bytes)
        kept +=
            std::ranges::equal(texels.subspan(at, texel_bytes), decoded.subspan(at, texel_bytes));
    return 2 * kept * texel_bytes > texels.size();
}

EffortSettings settings_of_edited_tiles(EffortSettings settings) {
    constexpr float bits_count_for = 0.1f; // codec/DECISIONS.md
    settings.quantizer.lambda *= bits_count_for;
    settings.search.lambda *= bits_count_for;
    return settings;
}

std::string about_reused_tile(const EncodePlan& plan, std::uint64_t number) {
    return plan.reused->container().name() + ": tile " + std::to_string(number);
}

Result<std::uint64_t> count_kept_tiles(const EncodePlan& plan, const PassResult& pass) {
    const ContainerReader& container = plan.reused->container();
    std::uint64_t count = 0;
    std::vector<std::byte> ours, theirs;
    for (std::uint64_t i = 0; i < pass.tiles.size(); ++i) {
        TESSERA_TRY_ASSIGN(const TileLocation location, container.locate(i));
        if (location.length != pass.tiles[i].payload_bytes)
            continue;
        TESSERA_TRY(pass.payloads->get(i, ours));
        TESSERA_TRY(container.read_tile(i, theirs));
        count += ours == theirs;
    }
    return count;
}

} // namespace tessera
