// The library and the second decoder agree on files with layers, and on what they mean.
#include "format/container/syntax.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "format/layers.h"
#include "tests/reference/agreement.h"
#include "tests/reference/spec_container.h"
#include "tests/reference/spec_layers.h"
#include "tests/support/random_rays.h"

#include <glm/geometric.hpp>

namespace tessera {
namespace {

using namespace test;

Bytes small_layer(const Extent4& size, int channels, AngularMap map) {
    CodeTexture texture = make_texture("waves", size, channels);
    EncodeOptions options;
    options.tile_extent = {16, 16, 4, 4};
    options.threads = 1;
    options.effort = 0;
    options.description.angular_map = map;
    Bytes file;
    EXPECT_TRUE(encode_memory(texture, file, options).ok());
    return file;
}

Bytes joined_layers() {
    const Bytes diffuse = small_layer({20, 17, 1, 1}, 3, AngularMap::none),
                specular = small_layer({20, 17, 1, 1}, 3, AngularMap::none),
                visibility = small_layer({5, 5, 2, 1}, 1, AngularMap::none),
                reflection = small_layer({2, 3, 4, 4}, 3, AngularMap::octahedral_mirrored),
                environment = small_layer({3, 1, 8, 8}, 3, AngularMap::octahedral_mirrored),
                difference = small_layer({3, 2, 4, 4}, 3, AngularMap::octahedral_mirrored),
                shared = small_layer({1, 1, 9, 9}, 3, AngularMap::octahedral_mirrored),
                opacity = small_layer({7, 6, 1, 1}, 1, AngularMap::none);
    const std::vector<LayerFile> further{
        {LayerRole::specular, 1.0f, specular},     {LayerRole::visibility, 1.0f, visibility},
        {LayerRole::reflection, 3.0f, reflection}, {LayerRole::environment, 9.0f, environment},
        {LayerRole::difference, 0.5f, difference}, {LayerRole::shared_difference, 0.25f, shared},
        {LayerRole::opacity, 1.0f, opacity}};
    const std::vector<DistantLight> lights{{{0.6f, 0.8f, 0}, 0.1f, {1, 2, 3}},
                                           {{0, 0, -1}, 0, {0, 1, 0.5f}}};
    const auto file = join_layers(diffuse, 0.75f, further, lights);
    EXPECT_TRUE(file.ok()) << file.status().message();
    return *file;
}

TEST(LayerAgreement, EveryLayerDecodesTheSame) {
    const Bytes file = joined_layers();
    expect_decodes(file, "the first layer");
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader.ok());
    const auto header = reference::spec::read_header(file);
    const auto sections = reference::spec::read_sections(file, header);
    const auto& index = sections.at("INDX");
    const auto table = reference::spec::read_layers(sections.at("LAYR").bytes,
                                                    index.offset + index.bytes.size(), file.size());
    ASSERT_EQ(table.further.size(), reader->layers().further.size());
    for (std::size_t i = 0; i < table.further.size(); ++i) {
        const LayerInfo& info = reader->layers().further[i];
        EXPECT_EQ(table.further[i].role, static_cast<int>(info.role));
        EXPECT_EQ(table.further[i].scale, info.scale);
        const Bytes own = reference::spec::layer_file(file, table.further[i]);
        Bytes read(own.size());
        ASSERT_TRUE(layer_bytes(*source, info)->read(0, read).ok());
        EXPECT_TRUE(own == read);
        expect_decodes(own, name_of(info.role));
    }
    for (std::size_t j = 0; j < table.lights.size(); ++j)
        for (glm::length_t c = 0; c < 3; ++c) {
            const auto at = static_cast<std::size_t>(c);
            EXPECT_NEAR(table.lights[j].direction[at], reader->layers().lights[j].direction[c],
                        1e-6);
            EXPECT_EQ(table.lights[j].irradiance[at],
                      static_cast<double>(reader->layers().lights[j].irradiance[c]));
        }
}

// Both refuse, or accept, the file with any byte of section LAYR changed.
TEST(LayerAgreement, ForgedTables) {
    const Bytes good = joined_layers();
    const auto source = wrap_memory(good);
    const auto reader = ContainerReader::open(*source);
    const FileHeader header = reader->header();
    SectionInfo layers;
    std::size_t entry = header_bytes;
    for (const SectionInfo& section : reader->sections()) {
        layers = section;
        if (section.type == "LAYR")
            break;
        entry += section_entry_bytes;
    }
    unsigned accepted = 0, refused = 0;
    for (std::size_t i = 0; i < layers.length; ++i)
        for (const int change : {1, 2, 0x80, 0xFF}) {
            Bytes file = good;
            file[layers.offset + i] ^= static_cast<std::byte>(change);
            store_le(file.data() + entry + 4,
                     tessera::crc32c(std::span(file).subspan(layers.offset, layers.length)));
            const auto table =
                std::span(file).subspan(header_bytes, header.section_count * section_entry_bytes);
            store_le(
                file.data() + header_crc_offset,
                tessera::crc32c(table, tessera::crc32c(std::span(file).first(header_crc_offset))));
            const Outcome outcome = expect_agreement(file, "byte " + std::to_string(i) + " xor " +
                                                               std::to_string(change));
            ++(outcome.accepted ? accepted : refused);
        }
    EXPECT_GT(accepted, 50u);
    EXPECT_GT(refused, 50u);
}

TEST(LayerAgreement, SignedSamplesAreTheSame) {
    for (int code = 0; code < 256; ++code)
        EXPECT_EQ(reference::difference_of(code / 255.0), signed_value(code / 255.0)) << code;
    EXPECT_EQ(signed_value(128 / 255.0), 0.0);
}

TEST(LayerAgreement, BlendingIsTheSame) {
    std::mt19937 engine(9);
    const auto unit = [&] { return random_unit(engine); };
    for (int i = 0; i < 256; ++i) {
        const double opacity = i / 255.0;
        const glm::dvec3 light(unit(), 3 * unit(), 0.0), behind(unit(), unit(), unit());
        const reference::Vector expected = reference::seen_of({light.x, light.y, light.z}, opacity,
                                                              {behind.x, behind.y, behind.z});
        const glm::dvec3 own =
            opacity >= full_opacity ? glm::min(light, 1.0) : blended(light, opacity, behind);
        for (glm::length_t c = 0; c < 3; ++c)
            ASSERT_NEAR(own[c], expected[static_cast<std::size_t>(c)], 1e-12) << i;
    }
}

reference::Vector vector_of(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

TEST(LayerAgreement, ShadingIsTheSame) {
    std::mt19937 engine(7);
    const auto unit = [&] { return random_unit(engine); };
    const auto direction = [&] {
        const double z = 2 * unit() - 1, angle = 6.283 * unit(), r = std::sqrt(1 - z * z);
        return glm::dvec3(r * std::cos(angle), r * std::sin(angle), z);
    };
    for (int i = 0; i < 2000; ++i) {
        SurfaceFrame frame;
        frame.ez = direction();
        frame.ex = glm::normalize(glm::cross(frame.ez, direction()));
        frame.ey = glm::cross(frame.ez, frame.ex);
        const glm::dvec3 view = direction();
        const glm::dvec2 samples(unit(), unit());
        std::vector<DistantLight> lights(3);
        for (DistantLight& light : lights)
            light = {glm::vec3(direction()), static_cast<float>(unit()),
                     glm::vec3(unit(), 4 * unit(), unit())};
        const std::vector<double> seen{unit(), unit(), unit()};
        Reflectance own{.view = view};
        own.normal = facing_normal(bumped_normal(frame, (samples * 255.0 - 128.0) / 127.0), view);
        own.specular = {unit(), unit(), unit()};
        own.roughness = unit() * unit();
        lights[2].spread = 0;
        const bool mirrors = i % 2 == 1; // has a layer of the environment
        const glm::dvec3 diffuse(unit(), unit(), unit()), reflected(unit(), 5 * unit(), unit()),
            environment(unit(), 9 * unit(), unit());
        glm::dvec3 light = diffuse + own.of_reflection() * reflected;
        const auto peaks = visibility_peaks(lights);
        LightSum sum;
        for (std::size_t j = 0; j < lights.size(); ++j)
            sum.add(lights[j], own.of(lights[j]), std::min(1.0, seen[j] / peaks[j]));
        light += mirrors ? sum.with_environment(own.of_reflection() * environment, own.roughness)
                         : sum.points + sum.patches;

        reference::LayerValues values;
        values.D = vector_of(diffuse);
        values.G = vector_of(own.specular);
        values.R = vector_of(reflected);
        values.r = own.roughness;
        values.has_specular = values.has_normal = true;
        values.has_environment = mirrors;
        values.X = vector_of(environment);
        values.a = samples.x;
        values.b = samples.y;
        values.x = seen;
        for (const DistantLight& l : lights)
            values.lights.push_back({vector_of(glm::dvec3(l.direction)),
                                     static_cast<double>(l.spread),
                                     vector_of(glm::dvec3(l.irradiance))});
        const reference::Frame same{vector_of(frame.ex), vector_of(frame.ey), vector_of(frame.ez)};
        const reference::Vector expected = reference::light_of(values, same, vector_of(view));
        for (glm::length_t c = 0; c < 3; ++c)
            ASSERT_NEAR(light[c], expected[static_cast<std::size_t>(c)],
                        1e-6 * std::max(1.0, std::abs(light[c])))
                << i;
    }
}

} // namespace
} // namespace tessera
