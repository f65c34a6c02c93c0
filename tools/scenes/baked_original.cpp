#include "tools/scenes/baked_original.h"

#include "corpus/bake.h"
#include "tools/support/parse.h"

namespace tessera {
namespace {

std::uint64_t stored_number(const Metadata& metadata, const std::string& key,
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
    // Such textures have a mask, and a comparison would mostly find differences in masked texels.
    if (metadata.contains("Texels per unit"))
        return Status(ErrorCode::unsupported,
                      name + ": was baked on a mesh, but only spheres can be baked again");
    const std::uint64_t samples =
        bake.samples ? *bake.samples : stored_number(metadata, "Samples per texel", usual_samples);
    if (samples > corpus::max_samples_per_texel)
        return Status(ErrorCode::bad_argument,
                      name + ": states " + std::to_string(samples) +
                          " samples per texel, which is too many; --spp overrides this number");
    return corpus::make_baked_source(bake.scene, size, static_cast<unsigned>(samples),
                                     bake.seed ? *bake.seed : stored_number(metadata, "Seed", 1),
                                     baked_window(description));
}

} // namespace tessera
