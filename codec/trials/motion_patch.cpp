#include "codec/trials/motion_patch.h"

#include "format/samples.h"

#include <span>

namespace tessera {
namespace {

constexpr Extent4 motion_patch_extent{64, 64, 3, 3};
constexpr std::uint64_t most_motion_patches = 16;

} // namespace

MotionPatch::MotionPatch(const Box4& box, const TileTexels& tile, const TextureDesc& desc)
    : extent_(box.extent()), matters_(tile.matters) {
    const std::span<const std::byte> texels = tile.texels;
    const std::size_t green = desc.channels >= 3 ? 1 : 0, bytes = sample_bytes(desc.type);
    for (std::size_t at = green * bytes; at < texels.size(); at += desc.texel_bytes())
        codes_.push_back(sample_code(load_sample(texels.data() + at, desc.type), desc.type));
}

Result<std::vector<MotionPatch>> read_motion_patches(const EncodePlan& plan) {
    EncodePlan cut = plan;
    cut.grid = TileGrid(plan.colour.desc.size, motion_patch_extent);
    TESSERA_TRY_ASSIGN(const Sample sample, read_sample(cut, most_motion_patches));
    std::vector<MotionPatch> patches;
    for (std::size_t i = 0; i < sample.boxes.size(); ++i)
        patches.emplace_back(sample.boxes[i], sample.tiles[i], plan.colour.desc);
    return patches;
}

} // namespace tessera
