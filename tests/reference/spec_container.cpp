#include "tests/reference/spec_container.h"

#include "tests/reference/spec_decoder.h"
#include "tests/reference/spec_layers.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <zstd.h>

namespace tessera_reference::spec {

namespace {

constexpr size_t header_bytes = 92;
constexpr size_t section_entry_bytes = 12;

} // namespace

Header read_header(Bytes file) {
    require(file.size() >= header_bytes, "header: cut short");
    const uint8_t identifier[12] = {0x89, 'T', 'E', 'S', 'S', 'E', 'R', 'A', 13, 10, 0x1A, 10};
    require(std::memcmp(file.data(), identifier, 12) == 0, "header: identifier");
    require(u16(file, 12) == 0 && (u16(file, 14) == 5 || u16(file, 14) == 6), "header: version");

    Header h;
    h.section_count = static_cast<uint32_t>(u8(file, 36));
    require(h.section_count <= 62, "header: section_count"); // part 6, number 2: counts as cut off
    const size_t table_end = header_bytes + h.section_count * section_entry_bytes;
    require(file.size() >= table_end, "section table: cut short");
    uint32_t crc = crc32c(file.first(88));
    crc = crc32c(file.subspan(header_bytes, table_end - header_bytes), crc);
    require(crc == u32(file, 88), "header: header_crc");

    h.required_features = u32(file, 16);
    for (int bit = 0; bit < 32; ++bit)
        if (h.required_features >> bit & 1 && bit != 0 && bit != 1 && bit != 4 && bit != 5 &&
            bit != 6 && bit != 7 && bit != 8 && bit != 9 && bit != 10) // 1.6
            throw Refusal{"unknown required feature " + std::to_string(bit)};
    require(!(h.has_corrections() && h.has_predictions()), "header: bits 1 and 4 together");
    require(h.has_layers() == (u16(file, 14) == 6), "header: version and feature 7");
    require(h.section_count >= 1, "header: section_count");
    h.file_size = u64(file, 24);
    require(h.file_size == file.size(), "header: file_size");
    h.index_size = u32(file, 32);
    h.page_target = u16(file, 38);
    require(h.page_target <= 4096, "header: page_target");

    uint64_t texels = 1;
    for (size_t a = 0; a < 4; ++a) {
        h.size[a] = u32(file, 40 + 4 * a);
        require(h.size[a] >= 1 && h.size[a] <= 1u << 20, "header: size");
        require(texels <= (1ull << 48) / h.size[a], "header: size product");
        texels *= h.size[a];
    }
    uint32_t tile_texels = 1;
    for (size_t a = 0; a < 4; ++a) {
        h.tile_extent[a] = u8(file, 56 + a) + 1u;
        require(h.tile_extent[a] <= (a < 2 ? 256 : 32), "header: tile_extent");
        tile_texels *= h.tile_extent[a];
    }
    require(tile_texels <= (h.has_corrections() ? 65536 : 393216), "header: tile_extent product");

    h.sample_type = u8(file, 60);
    require(h.sample_type <= 1, "header: sample_type");
    h.channels = u8(file, 61);
    require(h.channels >= 1 && h.channels <= 4, "header: channels");
    h.colour = u8(file, 62);
    require(h.colour == 0 || (h.colour == 1 && h.channels >= 3), "header: colour");
    const int alpha = u8(file, 63);
    require(alpha == 0 || (alpha <= 2 && h.channels % 2 == 0), "header: alpha");
    h.proxy = u8(file, 64);
    // Bytes 65..68 and unknown values of proxy do not affect the texels.
    h.level_count = static_cast<uint32_t>(u8(file, 37));
    require(h.level_count >= 1 && h.level_count <= 64, "header: level_count");
    require((h.level_count > 1) == h.has_levels(), "header: level_count and feature 0");
    require(u8(file, 69) == 0, "header: reserved");
    h.grid = h.size;
    for (size_t a = 0; a < 2; ++a) {
        h.alignment[a] = u8(file, 70 + a) < 128 ? u8(file, 70 + a) : u8(file, 70 + a) - 256;
        h.grid[a] += static_cast<uint32_t>(std::abs(h.alignment[a])) * (h.size[2 + a] - 1);
        require(h.grid[a] <= 1u << 20, "header: alignment");
    }
    require(h.is_aligned() == (h.alignment[0] != 0 || h.alignment[1] != 0),
            "header: alignment and feature 6");
    require(!h.is_aligned() || (h.level_count == 1 && h.proxy == 0), "header: aligned views");
    require(uint64_t{h.grid[0]} * h.grid[1] <= (1ull << 48) / h.size[2] / h.size[3],
            "header: alignment, product");

    for (size_t c = 0; c < 4; ++c) {
        const uint16_t sample = u16(file, 72 + 2 * c);
        h.background[c] = sample;
        if (c >= static_cast<size_t>(h.channels))
            require(sample == 0, "header: background of an unused channel");
        else if (h.sample_type == 0)
            require(sample <= 255, "header: background");
        else
            require((sample & 0x7FFF) < 0x7C00, "header: background");
    }
    h.identity = u64(file, 80);
    return h;
}

std::map<std::string, Section> read_sections(Bytes file, const Header& header) {
    std::map<std::string, Section> sections;
    const auto add = [&](const std::string& type, uint64_t offset, uint64_t length) {
        require(length <= file.size() - offset, "section table: length");
        require(!sections.contains(type), "section table: a type stands twice");
        sections[type] = {offset, file.subspan(offset, length)};
        return offset + length;
    };
    uint64_t end = header_bytes + header.section_count * section_entry_bytes;
    for (uint32_t i = 0; i < header.section_count; ++i) {
        const Bytes entry = file.subspan(header_bytes + i * section_entry_bytes);
        std::string type;
        for (size_t k = 0; k < 4; ++k) {
            const char c = static_cast<char>(u8(entry, k));
            require((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'), "section table: type");
            type += c;
        }
        const bool known = type == "CODE" || type == "LEVL" || type == "ROOT" || type == "LAYR";
        if (type[0] <= 'Z' && !known)
            throw Refusal{"unknown required section " + type};
        end = add(type, end, u32(entry, 8));
        require(u32(entry, 4) == crc32c(sections.at(type).bytes), "section crc");
    }
    require(end <= 1u << 28, "section table: the head is too long");
    end = add("INDX", end, header.index_size);
    require(sections.contains("LAYR") == header.has_layers(), "section table: LAYR");
    if (header.has_layers()) {
        const LayerTable layers = read_layers(sections.at("LAYR").bytes, end, file.size());
        add("DATA", layers.data_offset, layers.data_bytes);
    } else {
        add("DATA", end, file.size() - end);
    }
    require(sections.contains("CODE"), "section table: CODE is missing");
    require(sections.contains("LEVL") == (header.level_count > 1), "section table: LEVL");
    return sections;
}

void check_geometry(const std::map<std::string, Section>& sections, const Header& header) {
    const bool is_sphere = header.proxy == 1 || header.proxy == 3;
    if (!sections.contains("geom")) {
        require(!is_sphere, "geom: missing");
        return;
    }
    const Bytes section = sections.at("geom").bytes;
    require(section.size() == 24, "geom: length");
    bool any = false;
    for (size_t at = 0; at < 24; at += 4) {
        require(std::isfinite(f32(section, at)), "geom: not finite");
        any = any || f32(section, at) != 0;
    }
    require(any, "geom: all numbers are 0");
    const float radius = f32(section, 12);
    require(is_sphere ? radius > 0 : radius == 0, "geom: sphere_radius");
    require(f32(section, 16) >= 0 && f32(section, 16) <= f32(section, 20), "geom: viewing_radius");
}

namespace {

bool is_utf8_without_nul(const std::string& text) {
    size_t i = 0;
    while (i < text.size()) {
        const auto byte = [&](size_t k) { return static_cast<uint8_t>(text[k]); };
        const uint8_t first = byte(i);
        int more = 0;
        uint32_t code = 0;
        if (first < 0x80) {
            code = first;
        } else if (first >= 0xC0 && first < 0xE0) {
            more = 1;
            code = first & 0x1F;
        } else if (first >= 0xE0 && first < 0xF0) {
            more = 2;
            code = first & 0x0F;
        } else if (first >= 0xF0 && first < 0xF8) {
            more = 3;
            code = first & 0x07;
        } else {
            return false;
        }
        for (int k = 0; k < more; ++k) {
            ++i;
            if (i >= text.size() || (byte(i) & 0xC0) != 0x80)
                return false;
            code = code << 6 | (byte(i) & 0x3F);
        }
        const uint32_t smallest[4] = {1, 0x80, 0x800, 0x10000};
        if (code < smallest[more] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF))
            return false;
        ++i;
    }
    return true;
}

} // namespace

std::map<std::string, std::string> read_metadata(Bytes section) {
    const int packing = u8(section, 0);
    const uint32_t unpacked_size = u32(section, 1);
    const Bytes packed = section.subspan(5);
    require(packing <= 1, "metadata: packing");
    require(unpacked_size <= 1u << 24, "metadata: unpacked size");

    std::vector<std::byte> text(packed.begin(), packed.end());
    if (packing == 1) {
        const size_t frame = ZSTD_findFrameCompressedSize(packed.data(), packed.size());
        require(!ZSTD_isError(frame) && frame == packed.size(), "metadata: not one frame");
        text.assign(unpacked_size, std::byte{0});
        const size_t got = ZSTD_decompress(text.data(), text.size(), packed.data(), packed.size());
        require(!ZSTD_isError(got), "metadata: damaged frame");
        text.resize(got);
    }
    require(text.size() == unpacked_size, "metadata: unpacked size");

    std::map<std::string, std::string> metadata;
    const uint32_t count = u32(text, 0);
    require(count <= 65536, "metadata: count");
    size_t at = 4;
    std::string last;
    const auto take = [&](size_t length) {
        require(length <= text.size() - at, "metadata: cut short");
        std::string part(reinterpret_cast<const char*>(text.data()) + at, length);
        require(is_utf8_without_nul(part), "metadata: UTF-8 without NUL");
        at += length;
        return part;
    };
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t key_length = u16(text, at);
        const uint32_t value_length = u32(text, at + 2);
        at += 6;
        require(key_length >= 1 && key_length <= 255, "metadata: key length");
        require(value_length <= 1u << 20, "metadata: value length");
        const std::string key = take(key_length);
        require(i == 0 || last < key, "metadata: order"); // std::string compares bytes
        metadata[key] = take(value_length);
        last = key;
    }
    require(at == text.size(), "metadata: the last entry must end the text");
    return metadata;
}

} // namespace tessera_reference::spec
