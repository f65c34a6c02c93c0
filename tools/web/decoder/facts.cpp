#include "tools/web/decoder/facts.h"

#include "format/samples.h"

#include <array>

namespace tessera {
namespace {

template <class Values> void append(std::vector<double>& out, const Values& values) {
    for (const auto value : values)
        out.push_back(static_cast<double>(value));
}

// This build cannot unpack Zstandard (FORMAT.md 1.3, packing 1).
bool has_packed_metadata(const ContainerReader& container) {
    const std::span<const std::byte> section = container.section_bytes("meta");
    return !section.empty() && section[0] == std::byte{1};
}

} // namespace

Extent4 level_size(const ContainerReader& container, std::size_t level) {
    return level == 0 ? container.desc().size : container.levels()[level].size;
}

std::vector<double> number_facts(const ContainerReader& container) {
    const TextureDesc& desc = container.desc();
    const Description& about = container.description();
    std::vector<double> out;
    append(out, desc.size);
    append(out, std::array{static_cast<int>(desc.type), int{desc.channels},
                           static_cast<int>(about.proxy), static_cast<int>(about.surface_map),
                           static_cast<int>(about.angular_map), static_cast<int>(about.transfer),
                           static_cast<int>(about.primaries), static_cast<int>(about.alpha)});
    append(out, about.sphere_centre);
    out.push_back(about.sphere_radius);
    append(out, about.viewing_radius);
    for (const std::uint16_t sample : container.facts().background)
        out.push_back(sample_value(sample, desc.type));
    out.push_back(static_cast<double>(container.file_bytes()));
    out.push_back(has_packed_metadata(container) ? 1 : 0);
    append(out, std::array{container.alignment().u, container.alignment().v});
    append(out, container.grid().size());
    out.push_back(static_cast<double>(container.levels().size()));
    for (std::size_t i = 0; i < container.levels().size(); ++i) {
        const Level& level = container.levels()[i];
        append(out, level_size(container, i));
        append(out, container.grid(i).tile_extent());
        append(out, container.grid(i).count());
        out.push_back(level.spatial_lod);
        out.push_back(level.angular_lod);
    }
    return out;
}

std::vector<double> layer_facts(const Layers& layers) {
    std::vector<double> out{layers.scale, static_cast<double>(layers.further.size())};
    for (const LayerInfo& layer : layers.further)
        append(out, std::array{static_cast<double>(layer.role), double{layer.scale}});
    out.push_back(static_cast<double>(layers.lights.size()));
    for (const DistantLight& light : layers.lights)
        append(out,
               std::array{light.direction.x, light.direction.y, light.direction.z, light.spread,
                          light.irradiance.x, light.irradiance.y, light.irradiance.z});
    return out;
}

std::string text_facts(const ContainerReader& container) {
    std::string out;
    const auto add = [&](const std::string& text) { out.append(text).push_back('\0'); };
    const Description& about = container.description();
    add(name_of(about.proxy));
    add(name_of(about.surface_map));
    add(name_of(about.angular_map));
    add(name_of(about.transfer));
    add(name_of(about.primaries));
    add(name_of(about.alpha));
    add(container.facts().colour);
    for (const auto& [key, value] : container.metadata()) {
        add(key);
        add(value);
    }
    return out;
}

} // namespace tessera
