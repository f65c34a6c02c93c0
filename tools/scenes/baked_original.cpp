#include "tools/scenes/baked_original.h"

#include "corpus/bake.h"
#include "tools/support/parse.h"

namespace tessera {
namespace {

std::uint64_t remembered(const Metadata& metadata, const std::string& key,
                         std::uint64_t otherwise) {
    const auto entry = metadata.find(key);
    std::uint64_t number = 0;
    return entry != metadata.end() && parse_number(entry->second, number) ? number : otherwise;
}

} // namespace

corpus::SphereWindow baked_window(const Description& d) {
    if (d.proxy != Proxy::sphere_inside)
        return {};
    return {{d.sphere_centre[0], d.sphere_centre[1], d.sphere_centre[2]}, d.sphere_radius, true};
}

Result<std::unique_ptr<TexelSource>> bake_again(const BakeAgain& bake, const std::string& name,
                                                const Extent4& size, const Description& description,
                                                const Metadata& metadata) {
    // A mask goes with those: most of what differs would be texels that do not matter.
    if (metadata.contains("Texels per unit"))
        return Status(ErrorCode::unsupported,
                      name + ": was baked on a mesh, and only spheres are baked again");
    const std::uint64_t samples =
        bake.samples ? *bake.samples : remembered(metadata, "Samples per texel", usual_samples);
    if (samples > corpus::max_samples_per_texel)
        return Status(ErrorCode::bad_argument,
                      name + ": says it has " + std::to_string(samples) +
                          " samples per texel, too many; --spp says another number");
    return corpus::make_baked_source(bake.scene, size, static_cast<unsigned>(samples),
                                     bake.seed ? *bake.seed : remembered(metadata, "Seed", 1),
                                     baked_window(description));
}

} // namespace tessera
