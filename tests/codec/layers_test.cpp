// Tests files with layers: joining, opening, and what a reader refuses.
#include "codec/decoder.h"
#include "format/container/layer_table.h"
#include "format/container/syntax.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "tests/support/encoded_file.h"

#include <cmath>
#include <functional>

namespace tessera {
namespace {

using namespace tessera::test;

Bytes layer_file(const Extent4& size, std::uint8_t channels, double shift,
                 AngularMap map = AngularMap::none) {
    MemoryTexture texture(
        {size, SampleType::unorm8, channels}, [&](int u, int v, int s, int t, int c) {
            return 0.5 + 0.4 * std::sin(shift + 0.3 * u + 0.2 * v + 0.5 * s + 0.7 * t + c);
        });
    EncodeOptions options;
    options.effort = 1;
    options.tile_extent = {16, 16, 4, 4};
    options.description.angular_map = map;
    Bytes file;
    EXPECT_TRUE(encode_memory(texture, file, options).ok());
    return file;
}

struct LayerFiles {
    Bytes diffuse = layer_file({40, 24, 1, 1}, 3, 0), specular = layer_file({40, 24, 1, 1}, 3, 1),
          visibility = layer_file({10, 6, 2, 2}, 1, 2),
          reflection = layer_file({5, 3, 4, 4}, 3, 3, AngularMap::octahedral_mirrored);
    std::vector<DistantLight> lights{{{0, 1, 0}, 0.25f, {1, 2, 3}},
                                     {{0.6f, 0, -0.8f}, 0, {4, 0, 1}}};

    std::vector<LayerFile> further() const {
        return {{LayerRole::specular, 1.0f, specular},
                {LayerRole::visibility, 1.0f, visibility},
                {LayerRole::reflection, 2.5f, reflection}};
    }
    Bytes joined() const {
        const auto file = join_layers(diffuse, 0.5f, further(), lights);
        EXPECT_TRUE(file.ok()) << file.status().message();
        return *file;
    }
};

const LayerFiles& files() {
    static const LayerFiles made;
    return made;
}

Bytes layer_texels(ByteSource& bytes) {
    const auto decoder = Decoder::open(bytes);
    EXPECT_TRUE(decoder.ok()) << decoder.status().message();
    Bytes texels(decoder->desc().box_bytes(Box4::whole(decoder->desc().size)));
    EXPECT_TRUE(decoder->decode_box(Box4::whole(decoder->desc().size), texels).ok());
    return texels;
}

// Every layer of a joined file decodes to the texels of the file that it was made from, the first
// one through the file itself.
TEST(LayeredFiles, HoldTheTexelsOfEachLayer) {
    const Bytes joined = files().joined();
    const auto source = wrap_memory(joined);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader.ok()) << reader.status().message();
    EXPECT_EQ(reader->file_bytes(), joined.size());
    EXPECT_EQ(reader->facts().version_minor, version_minor_layers);
    const Layers& layers = reader->layers();
    EXPECT_EQ(layers.scale, 0.5f);
    ASSERT_EQ(layers.further.size(), 3u);
    EXPECT_TRUE(layer_texels(*source) == layer_texels(*wrap_memory(files().diffuse)));
    const auto parts = files().further();
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const LayerInfo& info = layers.further[i];
        EXPECT_EQ(info.role, parts[i].role);
        EXPECT_EQ(info.scale, parts[i].scale);
        EXPECT_EQ(layers.find(info.role), &info);
        const auto bytes = layer_bytes(*source, info);
        Bytes whole(bytes->size());
        ASSERT_TRUE(bytes->read(0, whole).ok());
        EXPECT_TRUE(std::ranges::equal(whole, parts[i].bytes));
        EXPECT_TRUE(layer_texels(*bytes) ==
                    layer_texels(*wrap_memory({parts[i].bytes.begin(), parts[i].bytes.end()})));
        EXPECT_NE(bytes->name().find(name_of(info.role)), std::string::npos);
    }
    ASSERT_EQ(layers.lights.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i)
        for (glm::length_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(layers.lights[i].direction[c], files().lights[i].direction[c], 1e-4);
            EXPECT_EQ(layers.lights[i].irradiance[c], files().lights[i].irradiance[c]);
        }
    EXPECT_TRUE(validate_container(*source).empty());
}

// From a network source, one read brings the beginnings of all layers, and nothing else.
TEST(LayeredFiles, OpenWithTwoReads) {
    const Bytes joined = files().joined();
    const auto source = wrap_memory(joined);
    CountingByteSource counting(*source, true);
    const auto reader = ContainerReader::open(counting);
    ASSERT_TRUE(reader.ok());
    const Layers& layers = reader->layers();
    counting.reset();
    const auto sources = bytes_of_layers(counting, layers);
    ASSERT_TRUE(sources.ok());
    for (const auto& bytes : *sources)
        ASSERT_TRUE(Decoder::open(*bytes).ok());
    const std::uint64_t begin = layers.further.front().beginning_offset;
    ASSERT_EQ(counting.reads().size(), 1u);
    EXPECT_EQ(counting.reads()[0].offset, begin);
    EXPECT_EQ(counting.reads()[0].length, layers.data_offset - begin);
}

// The file with other bytes in section LAYR and correct checksums.
Bytes with_section(const std::function<void(std::span<std::byte>)>& edit) {
    Bytes file = files().joined();
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    for (const SectionInfo& section : reader->sections())
        if (section.type == "LAYR")
            edit(std::span(file).subspan(static_cast<std::size_t>(section.offset),
                                         static_cast<std::size_t>(section.length)));
    FileHeader header = load_header(std::span(file).first<header_bytes>());
    std::size_t offset = header_bytes + header.section_count * section_entry_bytes;
    for (std::size_t i = 0; i < header.section_count; ++i) {
        const std::size_t at = header_bytes + i * section_entry_bytes;
        SectionEntry entry = load_section(std::span(file).subspan(at).first<section_entry_bytes>());
        entry.crc = crc32c(std::span(file).subspan(offset, entry.length));
        std::ranges::copy(store_section(entry), file.begin() + static_cast<std::ptrdiff_t>(at));
        offset += entry.length;
    }
    const auto table =
        std::span(file).subspan(header_bytes, header.section_count * section_entry_bytes);
    store_le(file.data() + header_crc_offset,
             crc32c(table, crc32c(std::span(file).first<header_crc_offset>())));
    return file;
}

void expect_refused(const Bytes& file, const std::string& word,
                    ErrorCode code = ErrorCode::invalid_file) {
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    ASSERT_FALSE(reader.ok()) << word;
    EXPECT_EQ(reader.status().code(), code) << word;
    EXPECT_NE(reader.status().message().find(word), std::string::npos) << reader.status().message();
    const auto findings = validate_container(*source);
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].number, static_cast<int>(ContainerRule::layers));
}

TEST(LayeredFiles, RefuseDamagedTables) {
    constexpr std::size_t first = 8, bytes = 20, light = first + 3 * bytes;
    const auto set = [](std::size_t at, unsigned value) {
        return with_section([&](std::span<std::byte> s) { s[at] = static_cast<std::byte>(value); });
    };
    expect_refused(set(0, 0), "lists 0 layers");
    expect_refused(set(0, 32), "lists 32 layers");
    expect_refused(set(2, 1), "too many");
    expect_refused(set(2, 3), "ends within light 2");
    expect_refused(set(3, 255), "lights, more than");
    expect_refused(set(7, 0xFF), "scale of layer 0");
    expect_refused(set(first, 12), "unknown role 12", ErrorCode::unsupported);
    expect_refused(set(first, 0), "two diffuse");
    expect_refused(set(first + bytes, 6), "two reflection");
    expect_refused(set(first, 1), "needs a specular");
    expect_refused(set(first + 1, 1), "reserved");
    expect_refused(set(first + 7, 0x80), "scale of layer 1");
    expect_refused(set(first + 11, 1), "past the end"); // of its first part
    expect_refused(set(first + 19, 1), "past the end"); // of its DATA
    expect_refused(set(first + 19, 0xFF), "past the end");
    expect_refused(set(light + 7, 0x7C), "spread");
    expect_refused(set(light + 9, 0xBC), "irradiance");
    expect_refused(with_section([&](std::span<std::byte> s) {
                       std::ranges::fill(s.subspan(light, 6), std::byte{0});
                   }),
                   "no direction");
}

// The feature bit, the version and section LAYR come together.
TEST(LayeredFiles, RefuseAFeatureWithoutItsSection) {
    for (const bool feature : {true, false}) {
        Bytes file = feature ? files().diffuse : files().joined();
        FileHeader header = load_header(std::span(file).first<header_bytes>());
        header.required_features ^= feature_layers;
        for (const bool version : {true, false}) {
            header.version_minor = version == feature ? version_minor_layers : version_minor_plain;
            const auto bytes = store_header(header);
            std::ranges::copy(bytes, file.begin());
            const auto table =
                std::span(file).subspan(header_bytes, header.section_count * section_entry_bytes);
            store_le(file.data() + header_crc_offset,
                     crc32c(table, crc32c(std::span(file).first<header_crc_offset>())));
            const auto source = wrap_memory(file);
            const auto reader = ContainerReader::open(*source);
            ASSERT_FALSE(reader.ok());
            EXPECT_EQ(reader.status().code(), ErrorCode::invalid_file);
        }
    }
}

TEST(LayeredFiles, JoinOnlyWhatFits) {
    const Bytes joined = files().joined();
    const auto refused = [&](std::span<const std::byte> first, std::vector<LayerFile> further,
                             std::span<const DistantLight> lights, const std::string& word) {
        const auto file = join_layers(first, 1.0f, further, lights);
        ASSERT_FALSE(file.ok()) << word;
        EXPECT_EQ(file.status().code(), ErrorCode::bad_argument);
        EXPECT_NE(file.status().message().find(word), std::string::npos) << file.status().message();
    };
    const LayerFile specular{LayerRole::specular, 1.0f, files().specular};
    refused(joined, {specular}, {}, "layers of its own");
    refused(files().diffuse, {{LayerRole::specular, 1.0f, joined}}, {}, "layers of its own");
    refused(files().diffuse, {specular, specular}, {}, "two specular");
    refused(files().diffuse, {{LayerRole::reflection, 1.0f, files().reflection}}, files().lights,
            "lights need a specular");
    refused(files().diffuse, {specular, {LayerRole::visibility, 1.0f, files().visibility}}, {},
            "needs lights");
    refused(files().diffuse, {}, {}, "0 layers");
    refused(std::span(files().diffuse).first(50), {specular}, {}, "not a Tessera file");
}

TEST(LayeredFiles, RolesNeedTheirChannelsAndDirections) {
    Description mirrored;
    mirrored.angular_map = AngularMap::octahedral_mirrored;
    const auto ok = [&](LayerRole role, const Extent4& size, std::uint8_t channels,
                        const Description& description = {}) {
        return check_layer(role, {size, SampleType::unorm8, channels}, description, 5).ok();
    };
    EXPECT_TRUE(ok(LayerRole::diffuse, {9, 9, 1, 1}, 3));
    EXPECT_FALSE(ok(LayerRole::diffuse, {9, 9, 2, 1}, 3));
    EXPECT_FALSE(ok(LayerRole::normal, {9, 9, 1, 1}, 3));
    EXPECT_TRUE(ok(LayerRole::normal, {9, 9, 1, 1}, 2));
    EXPECT_TRUE(ok(LayerRole::opacity, {9, 9, 1, 1}, 1));
    EXPECT_FALSE(ok(LayerRole::opacity, {9, 9, 1, 1}, 3));
    EXPECT_FALSE(ok(LayerRole::opacity, {9, 9, 1, 2}, 1));
    EXPECT_TRUE(ok(LayerRole::visibility, {9, 9, 3, 2}, 1));
    EXPECT_FALSE(ok(LayerRole::visibility, {9, 9, 2, 2}, 1));
    EXPECT_TRUE(ok(LayerRole::reflection, {9, 9, 3, 2}, 3, mirrored));
    EXPECT_FALSE(ok(LayerRole::reflection, {9, 9, 3, 2}, 3));
}

// The beginning of a file shows the first layers.
TEST(LayeredFiles, MayBeCutOff) {
    Bytes file = files().joined();
    file.resize(file.size() - 1);
    const auto source = wrap_memory(file);
    EXPECT_FALSE(ContainerReader::open(*source).ok());
    const auto reader = ContainerReader::open(*source, {.allow_partial = true});
    ASSERT_TRUE(reader.ok()) << reader.status().message();
    for (const LayerInfo& info : reader->layers().further) {
        const auto bytes = layer_bytes(*source, info);
        const bool last = info.role == LayerRole::reflection;
        EXPECT_EQ(Decoder::open(*bytes).ok(), !last);
        EXPECT_TRUE(Decoder::open(*bytes, {.allow_partial = true}).ok());
    }
}

} // namespace
} // namespace tessera
