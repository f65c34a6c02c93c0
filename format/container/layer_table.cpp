#include "format/container/layer_table.h"

#include "format/container/syntax.h"
#include "format/io/bytes.h"
#include "format/samples.h"

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera {
namespace {

constexpr float direction_unit = 32767.0f; // of the 16-bit components of a direction

float load_float(std::uint32_t bits) {
    return std::bit_cast<float>(bits);
}

Status check_scale(float scale, std::size_t layer) {
    if (!std::isfinite(scale) || !(scale > 0.0f))
        return invalid("section LAYR: the scale of layer " + std::to_string(layer) +
                       " is not above 0");
    return {};
}

Result<LayerInfo> read_layer(ByteReader& bytes, std::size_t number) {
    std::uint8_t role = 0, reserved[3]{};
    std::uint32_t scale = 0, beginning = 0;
    std::uint64_t data = 0;
    if (!bytes.take(role) || !bytes.take(reserved[0]) || !bytes.take(reserved[1]) ||
        !bytes.take(reserved[2]) || !bytes.take(scale) || !bytes.take(beginning) ||
        !bytes.take(data))
        return invalid("section LAYR ends within layer " + std::to_string(number));
    if (reserved[0] != 0 || reserved[1] != 0 || reserved[2] != 0)
        return invalid("section LAYR: reserved bytes of layer " + std::to_string(number) +
                       " are not 0");
    LayerInfo layer{.role = static_cast<LayerRole>(role), .scale = load_float(scale)};
    if (!is_known(layer.role))
        return Status(ErrorCode::unsupported, "section LAYR: layer " + std::to_string(number) +
                                                  " has the unknown role " + std::to_string(role));
    TESSERA_TRY(check_scale(layer.scale, number));
    layer.beginning_bytes = beginning;
    layer.data_bytes = data;
    return layer;
}

Result<DistantLight> read_light(ByteReader& bytes, std::size_t number) {
    std::uint16_t fields[7]{};
    for (std::uint16_t& field : fields)
        if (!bytes.take(field))
            return invalid("section LAYR ends within light " + std::to_string(number));
    glm::vec3 direction;
    DistantLight light{.spread = half_to_float(fields[3])};
    for (glm::length_t c = 0; c < 3; ++c) {
        direction[c] = static_cast<std::int16_t>(fields[c]);
        light.irradiance[c] = half_to_float(fields[4 + c]);
    }
    const std::string name = "section LAYR: light " + std::to_string(number);
    if (!(glm::length(direction) > 0.0f))
        return invalid(name + " has no direction");
    light.direction = glm::normalize(direction);
    if (!(light.spread >= 0.0f) || !(light.spread <= std::numbers::pi_v<float>))
        return invalid(name + " has a spread outside 0..pi");
    for (glm::length_t c = 0; c < 3; ++c)
        if (!std::isfinite(light.irradiance[c]) || light.irradiance[c] < 0.0f)
            return invalid(name + " has an irradiance that is negative or not finite");
    return light;
}

// Places the layers' bytes one after the other.
Status place(Layers& layers, std::uint64_t beginning, std::uint64_t file_size) {
    const auto take = [&](std::uint64_t bytes, std::uint64_t& offset) -> Status {
        if (bytes > file_size - offset)
            return invalid("section LAYR: the layers reach past the end of the file");
        offset += bytes;
        return {};
    };
    std::uint64_t all_data = 0;
    for (LayerInfo& layer : layers.further) {
        layer.beginning_offset = beginning;
        TESSERA_TRY(take(layer.beginning_bytes, beginning));
        if (layer.data_bytes > file_size - all_data)
            return invalid("section LAYR: the layers reach past the end of the file");
        all_data += layer.data_bytes;
    }
    if (all_data > file_size - beginning)
        return invalid("section LAYR: the layers reach past the end of the file");
    layers.data_offset = beginning;
    layers.data_bytes = file_size - beginning - all_data;
    std::uint64_t data = layers.data_offset + layers.data_bytes;
    for (LayerInfo& layer : layers.further) {
        layer.data_offset = data;
        data += layer.data_bytes;
    }
    return {};
}

Status check_roles(const Layers& layers) {
    const auto has = [&](LayerRole role) { return layers.find(role) != nullptr; };
    for (const LayerInfo& layer : layers.further) {
        if (layer.role == LayerRole::diffuse || layers.find(layer.role) != &layer)
            return invalid(std::string("section LAYR has two ") + name_of(layer.role) + " layers");
        const bool refines = layer.role == LayerRole::roughness ||
                             layer.role == LayerRole::normal || layer.role == LayerRole::visibility;
        if (refines && !has(LayerRole::specular))
            return invalid(std::string("section LAYR: a ") + name_of(layer.role) +
                           " layer needs a specular layer");
    }
    if (!layers.lights.empty() && !has(LayerRole::specular))
        return invalid("section LAYR: lights need a specular layer");
    for (const LayerRole role : {LayerRole::visibility, LayerRole::environment})
        if (layers.lights.empty() && has(role))
            return invalid(std::string("section LAYR: a layer of role ") + name_of(role) +
                           " needs lights");
    return {};
}

} // namespace

const LayerInfo* Layers::find(LayerRole role) const {
    for (const LayerInfo& layer : further)
        if (layer.role == role)
            return &layer;
    return nullptr;
}

Status check_layer(LayerRole role, const TextureDesc& desc, const Description& description,
                   std::size_t lights) {
    constexpr std::array<unsigned, value_names<LayerRole>.size()> channels{3, 3, 3, 1, 2, 1,
                                                                           3, 1, 3, 3, 3, 1};
    const std::string name = std::string("the ") + name_of(role) + " layer has ";
    if (desc.channels != channels[static_cast<std::size_t>(role)])
        return invalid(name + std::to_string(desc.channels) + " channels, not " +
                       std::to_string(channels[static_cast<std::size_t>(role)]));
    const std::uint64_t directions = std::uint64_t{desc.size[axis_s]} * desc.size[axis_t];
    if (role == LayerRole::visibility) {
        if (directions < lights)
            return invalid(name + std::to_string(directions) + " directions for " +
                           std::to_string(lights) + " lights");
    } else if (role == LayerRole::reflection || role == LayerRole::environment || is_signed(role)) {
        if (role == LayerRole::environment && desc.size[axis_v] != 1)
            return invalid(name + std::to_string(desc.size[axis_v]) + " rows of places, not 1");
        if (description.angular_map != AngularMap::octahedral_mirrored)
            return invalid(name + "not the angular map octahedral-mirrored");
    } else if (directions != 1) {
        return invalid(name + std::to_string(directions) + " directions, not 1");
    }
    return {};
}

Result<Layers> read_layers(std::span<const std::byte> section, std::uint64_t first_beginning,
                           std::uint64_t file_size) {
    ByteReader bytes(section);
    std::uint8_t count = 0, reserved = 0;
    std::uint16_t lights = 0;
    std::uint32_t scale = 0;
    if (!bytes.take(count) || !bytes.take(reserved) || !bytes.take(lights) || !bytes.take(scale))
        return invalid("section LAYR has fewer than 8 bytes");
    if (count == 0 || count >= most_layers || reserved != 0)
        return invalid("section LAYR lists " + std::to_string(count) + " layers, not 1.." +
                       std::to_string(most_layers - 1));
    if (lights > most_lights)
        return invalid("section LAYR lists " + std::to_string(lights) + " lights, more than " +
                       std::to_string(most_lights));
    Layers layers;
    layers.scale = load_float(scale);
    TESSERA_TRY(check_scale(layers.scale, 0));
    for (std::size_t i = 1; i <= count; ++i) {
        TESSERA_TRY_ASSIGN(LayerInfo layer, read_layer(bytes, i));
        layers.further.push_back(layer);
    }
    for (std::size_t i = 0; i < lights; ++i) {
        TESSERA_TRY_ASSIGN(DistantLight light, read_light(bytes, i));
        layers.lights.push_back(light);
    }
    if (bytes.remaining() != 0)
        return invalid("section LAYR has " + std::to_string(bytes.remaining()) + " bytes too many");
    TESSERA_TRY(check_roles(layers));
    TESSERA_TRY(place(layers, first_beginning, file_size));
    return layers;
}

std::vector<std::byte> write_layers(const Layers& layers) {
    std::vector<std::byte> section;
    append_le(section, static_cast<std::uint8_t>(layers.further.size()));
    append_le(section, std::uint8_t{0});
    append_le(section, static_cast<std::uint16_t>(layers.lights.size()));
    append_le(section, std::bit_cast<std::uint32_t>(layers.scale));
    for (const LayerInfo& layer : layers.further) {
        append_le(section, static_cast<std::uint8_t>(layer.role));
        for (int i = 0; i < 3; ++i)
            append_le(section, std::uint8_t{0});
        append_le(section, std::bit_cast<std::uint32_t>(layer.scale));
        append_le(section, static_cast<std::uint32_t>(layer.beginning_bytes));
        append_le(section, layer.data_bytes);
    }
    for (const DistantLight& light : layers.lights) {
        for (glm::length_t c = 0; c < 3; ++c)
            append_le(section, static_cast<std::uint16_t>(static_cast<std::int16_t>(
                                   std::lround(light.direction[c] * direction_unit))));
        append_le(section, float_to_half(light.spread));
        for (glm::length_t c = 0; c < 3; ++c)
            append_le(section, float_to_half(std::min(light.irradiance[c], 65504.0f)));
    }
    return section;
}

} // namespace tessera
