// The numbers in the comments are the sections of format/FORMAT.md.
#include "tests/reference/spec_decoder.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

namespace tessera_reference {
namespace {

using std::int16_t;
using std::int32_t;
using std::int64_t;
using std::size_t;
using std::uint16_t;
using std::uint32_t;
using std::uint64_t;
using std::uint8_t;
using Bytes = std::span<const std::byte>;

// Why a file is refused.
struct Refusal {
    std::string reason;
};

void require(bool condition, const char* rule) {
    if (!condition)
        throw Refusal{rule};
}

// ------------------------------------------------------------------------------------- notation

uint64_t little_endian(Bytes bytes, size_t offset, size_t length) {
    require(offset <= bytes.size() && length <= bytes.size() - offset, "cut short");
    uint64_t value = 0;
    for (size_t i = 0; i < length; ++i)
        value |= static_cast<uint64_t>(bytes[offset + i]) << 8 * i;
    return value;
}
uint8_t u8(Bytes b, size_t at) {
    return static_cast<uint8_t>(little_endian(b, at, 1));
}
uint16_t u16(Bytes b, size_t at) {
    return static_cast<uint16_t>(little_endian(b, at, 2));
}
uint32_t u32(Bytes b, size_t at) {
    return static_cast<uint32_t>(little_endian(b, at, 4));
}
uint64_t u64(Bytes b, size_t at) {
    return little_endian(b, at, 8);
}
float f32(Bytes b, size_t at) {
    return std::bit_cast<float>(u32(b, at));
}

int64_t floor_div(int64_t a, int64_t b) { // b > 0
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

// The numbers as little-endian bytes, for the seeds of checksums.
struct Seed {
    std::vector<std::byte> bytes;
    Seed& add(uint64_t value, int length) {
        for (int i = 0; i < length; ++i)
            bytes.push_back(static_cast<std::byte>(value >> 8 * i & 255));
        return *this;
    }
};

// ---------------------------------------------------------------------------------- 1.1 the header

struct Header {
    uint64_t required_features = 0;
    uint64_t file_size = 0;
    uint32_t head_size = 0;
    uint32_t section_count = 0;
    uint32_t page_target = 0;
    std::array<uint32_t, 4> size{};
    std::array<int, 2> alignment{};
    std::array<uint32_t, 4> grid{}; // texels of level 0's grid (part 2)
    std::array<uint32_t, 4> tile_extent{};
    int sample_type = 0;
    int channels = 0;
    int colour = 0;
    uint32_t level_count = 0;
    std::array<uint16_t, 4> background{};
    uint64_t identity = 0;

    size_t texel_bytes() const { return static_cast<size_t>(channels) * (sample_type ? 2 : 1); }
    bool has_levels() const { return required_features & 1; }
    bool has_corrections() const { return required_features >> 1 & 1; }
    bool has_predictions() const { return required_features >> 4 & 1; }
    bool is_aligned() const { return required_features >> 6 & 1; }
    bool has_stored_tiles() const { return required_features >> 5 & 1; }
};

constexpr size_t header_bytes = 128;
constexpr size_t section_entry_bytes = 24;

Header read_header(Bytes file) {
    require(file.size() >= header_bytes, "header: cut short");
    const uint8_t identifier[12] = {0x89, 'T', 'E', 'S', 'S', 'E', 'R', 'A', 13, 10, 0x1A, 10};
    require(std::memcmp(file.data(), identifier, 12) == 0, "header: identifier");
    require(u16(file, 12) == 0 && u16(file, 14) == 2, "header: version");

    Header h;
    h.section_count = u16(file, 44);
    require(h.section_count <= 64, "header: section_count"); // part 6, number 2: counts as cut
    const size_t table_end = header_bytes + h.section_count * section_entry_bytes;
    require(file.size() >= table_end, "section table: cut short");
    uint32_t crc = crc32c(file.first(124));
    crc = crc32c(file.subspan(header_bytes, table_end - header_bytes), crc);
    require(crc == u32(file, 124), "header: header_crc");

    h.required_features = u64(file, 16);
    for (int bit = 0; bit < 64; ++bit)
        if (h.required_features >> bit & 1 && bit != 0 && bit != 1 && bit != 4 && bit != 5 &&
            bit != 6) // 1.5
            throw Refusal{"unknown required feature " + std::to_string(bit)};
    require(!(h.has_corrections() && h.has_predictions()), "header: bits 1 and 4 together");
    require(h.section_count >= 5, "header: section_count");
    h.file_size = u64(file, 32);
    require(h.file_size == file.size(), "header: file_size");
    h.head_size = u32(file, 40);
    require(h.head_size <= 1u << 28, "header: head_size");
    h.page_target = u16(file, 46);
    require(h.page_target <= 4096, "header: page_target");

    uint64_t texels = 1;
    for (size_t a = 0; a < 4; ++a) {
        h.size[a] = u32(file, 48 + 4 * a);
        require(h.size[a] >= 1 && h.size[a] <= 1u << 20, "header: size");
        require(texels <= (1ull << 48) / h.size[a], "header: size product");
        texels *= h.size[a];
    }
    uint32_t tile_texels = 1;
    for (size_t a = 0; a < 4; ++a) {
        h.tile_extent[a] = u8(file, 64 + a);
        require(h.tile_extent[a] >= 1 && h.tile_extent[a] <= (a < 2 ? 64 : 32),
                "header: tile_extent");
        tile_texels *= h.tile_extent[a];
    }
    require(tile_texels <= 65536, "header: tile_extent product");

    h.sample_type = u8(file, 68);
    require(h.sample_type <= 1, "header: sample_type");
    h.channels = u8(file, 69);
    require(h.channels >= 1 && h.channels <= 4, "header: channels");
    h.colour = u8(file, 70);
    require(h.colour == 0 || (h.colour == 1 && h.channels >= 3), "header: colour");
    const int alpha = u8(file, 71);
    require(alpha == 0 || (alpha <= 2 && h.channels % 2 == 0), "header: alpha");
    const int proxy = u8(file, 72);
    // 73..76, like unknown values of proxy: the texels decode without them.
    h.level_count = u8(file, 77);
    require(h.level_count >= 1 && h.level_count <= 64, "header: level_count");
    require((h.level_count > 1) == h.has_levels(), "header: level_count and feature 0");
    require(u32(file, 120) == 0, "header: reserved");
    h.grid = h.size;
    for (size_t a = 0; a < 2; ++a) {
        h.alignment[a] = u8(file, 78 + a) < 128 ? u8(file, 78 + a) : u8(file, 78 + a) - 256;
        h.grid[a] += static_cast<uint32_t>(std::abs(h.alignment[a])) * (h.size[2 + a] - 1);
        require(h.grid[a] <= 1u << 20, "header: alignment");
    }
    require(h.is_aligned() == (h.alignment[0] != 0 || h.alignment[1] != 0),
            "header: alignment and feature 6");
    require(!h.is_aligned() || (h.level_count == 1 && proxy == 0), "header: aligned views");
    require(uint64_t{h.grid[0]} * h.grid[1] <= (1ull << 48) / h.size[2] / h.size[3],
            "header: alignment, product");

    for (size_t at = 80; at < 104; at += 4)
        require(std::isfinite(f32(file, at)), "header: not finite");
    const float radius = f32(file, 92);
    require(proxy == 1 || proxy == 3 ? radius > 0 : radius == 0, "header: sphere_radius");
    require(f32(file, 96) >= 0 && f32(file, 96) <= f32(file, 100), "header: viewing_radius");

    for (size_t c = 0; c < 4; ++c) {
        const uint16_t sample = u16(file, 104 + 2 * c);
        h.background[c] = sample;
        if (c >= static_cast<size_t>(h.channels))
            require(sample == 0, "header: background of an unused channel");
        else if (h.sample_type == 0)
            require(sample <= 255, "header: background");
        else
            require((sample & 0x7FFF) < 0x7C00, "header: background");
    }
    h.identity = u64(file, 112);
    return h;
}

// ------------------------------------------------------------------------------- 1.2 section table

struct Section {
    uint64_t offset = 0;
    Bytes bytes;
};

std::map<std::string, Section> read_section_table(Bytes file, const Header& header) {
    std::map<std::string, Section> sections;
    uint64_t end = header_bytes + header.section_count * section_entry_bytes;
    for (uint32_t i = 0; i < header.section_count; ++i) {
        const Bytes entry = file.subspan(header_bytes + i * section_entry_bytes);
        std::string type;
        for (size_t k = 0; k < 4; ++k) {
            const char c = static_cast<char>(u8(entry, k));
            require((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'), "section table: type");
            type += c;
        }
        const bool known =
            type == "CODE" || type == "LEVL" || type == "ROOT" || type == "INDX" || type == "DATA";
        if (type[0] <= 'Z' && !known)
            throw Refusal{"unknown required section " + type};
        require(!sections.contains(type), "section table: a type stands twice");

        const uint64_t offset = u64(entry, 8), length = u64(entry, 16);
        require(offset == end, "section table: offset");
        require(length <= file.size() - offset, "section table: length");
        end = offset + length;
        const Bytes bytes = file.subspan(offset, length);
        if (type == "INDX" || type == "DATA")
            require(u32(entry, 4) == 0, "section table: crc of INDX or DATA");
        else
            require(u32(entry, 4) == crc32c(bytes), "section crc");

        if (type == "INDX") {
            require(i == header.section_count - 2, "section table: INDX is not last but one");
            require(offset == header.head_size, "section table: head_size");
        }
        if (type == "DATA")
            require(i == header.section_count - 1, "section table: DATA is not last");
        sections[type] = {offset, bytes};
    }
    require(end == header.file_size, "section table: the last section must end the file");
    for (const char* needed : {"CODE", "LEVL", "ROOT", "INDX", "DATA"})
        require(sections.contains(needed), "section table: a needed section is missing");
    return sections;
}

// ------------------------------------------------------------------------------------ 1.3 metadata

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

// ------------------------------------------------------------ 1.4 levels, tiles, groups, pages

struct Level {
    std::array<uint32_t, 4> size{};
    std::array<uint64_t, 4> n{}; // tiles along the axes (part 2)
    uint64_t first_tile = 0, tiles = 1;
    int step_shift = 0;
};

std::vector<Level> read_levels(Bytes section, const Header& header) {
    require(section.size() == 24 * header.level_count, "LEVL: length");
    std::vector<Level> levels;
    int spatial = 0, angular = 0;
    uint64_t tiles = 0;
    for (size_t i = 0; i < header.level_count; ++i) {
        const Bytes entry = section.subspan(24 * i, 24);
        const int spatial_lod = u8(entry, 16), angular_lod = u8(entry, 17);
        require(u8(entry, 18) == 0 && u32(entry, 20) == 0, "LEVL: quality_layer, reserved");
        Level level;
        level.step_shift = u8(entry, 19);
        if (i == 0)
            require(u64(entry, 16) == 0, "LEVL: entry 0 has zeros");
        else
            require(spatial_lod >= spatial && angular_lod >= angular &&
                        (spatial_lod > spatial || angular_lod > angular) && spatial_lod <= 20 &&
                        angular_lod <= 20 && level.step_shift <= 15,
                    "LEVL: lods and step_shift");
        spatial = spatial_lod;
        angular = angular_lod;
        for (size_t a = 0; a < 4; ++a) {
            const uint64_t joined = 1ull << (a < 2 ? spatial : angular);
            level.size[a] = u32(entry, 4 * a);
            require(level.size[a] == (header.grid[a] + joined - 1) / joined, "LEVL: size");
            level.n[a] = (level.size[a] + header.tile_extent[a] - 1) / header.tile_extent[a];
            level.tiles *= level.n[a]; // at most 2^48, as the texels
        }
        level.first_tile = tiles;
        tiles += level.tiles;
        require(tiles <= 0xFFFFFFFF, "too many tiles");
        levels.push_back(level);
    }
    return levels;
}

// The tiles of every group, in the order of the groups: first tile and number.
std::vector<std::pair<uint64_t, uint64_t>> make_groups(const std::vector<Level>& levels) {
    std::vector<std::pair<uint64_t, uint64_t>> groups;
    for (size_t i = levels.size(); i-- > 0;)
        for (uint64_t t = 0; t < levels[i].tiles; t += 256)
            groups.push_back(
                {levels[i].first_tile + t, std::min<uint64_t>(256, levels[i].tiles - t)});
    return groups;
}

class BitReader {
public:
    explicit BitReader(Bytes bytes) : bytes_(bytes) {}
    uint64_t bits(int count) { // first bit in the lowest bit of the first byte
        uint64_t value = 0;
        for (int i = 0; i < count; ++i) {
            require(at_ / 8 < bytes_.size(), "index record: cut short");
            value |= static_cast<uint64_t>(u8(bytes_, at_ / 8) >> at_ % 8 & 1) << i;
            ++at_;
        }
        return value;
    }
    size_t finish() { // zero bits fill the last byte; the number of bytes
        while (at_ % 8 != 0)
            require(bits(1) == 0, "index record: padding");
        return at_ / 8;
    }

private:
    Bytes bytes_;
    size_t at_ = 0;
};

// One index record without its checksums: the lengths of n tiles. `used` becomes its bytes.
std::vector<uint64_t> read_lengths(Bytes record, size_t n, size_t& used) {
    BitReader reader(record);
    const int k = static_cast<int>(reader.bits(5));
    const bool has_empty = reader.bits(1);
    std::vector<bool> present(n, true);
    if (has_empty)
        for (size_t i = 0; i < n; ++i)
            present[i] = reader.bits(1);
    std::vector<uint64_t> lengths(n, 0);
    for (size_t i = 0; i < n; ++i) {
        if (!present[i])
            continue;
        uint64_t q = 0;
        while (q < 24 && reader.bits(1))
            ++q;
        const uint64_t value = q < 24 ? (q << k) + reader.bits(k) : reader.bits(32);
        require(value <= (1ull << 32) - 2, "index record: length");
        lengths[i] = value + 1;
    }
    used = reader.finish();
    return lengths;
}

// The sizes of the pages into which a group's tiles are gathered.
std::vector<uint64_t> page_sizes(const std::vector<uint64_t>& lengths, uint32_t page_target) {
    std::vector<uint64_t> pages;
    uint64_t p = 0;
    const auto close = [&] {
        if (p > 0)
            pages.push_back(p);
        p = 0;
    };
    for (uint64_t n : lengths) {
        if (n > 65536) {
            close();
            for (; n >= 65536; n -= 65536)
                pages.push_back(65536);
            if (n > 0)
                pages.push_back(n);
        } else {
            if (p + n > 16 * page_target)
                close();
            p += n;
        }
    }
    close();
    return pages;
}

// The payload of every tile, by number, all checksums checked.
std::vector<Bytes> read_tiles(Bytes file, const Header& header,
                              const std::map<std::string, Section>& sections,
                              const std::vector<Level>& levels) {
    const Bytes root = sections.at("ROOT").bytes;
    const Section& index = sections.at("INDX");
    const Section& data = sections.at("DATA");
    const auto group_tiles = make_groups(levels);
    const uint64_t groups = group_tiles.size();
    uint64_t longest = 16 * header.channels;
    for (const uint32_t extent : header.tile_extent)
        longest *= extent;
    longest += 1u << 18;
    require(root.size() == 12 * (groups + 1), "ROOT: length");
    require(u64(root, 0) == data.offset && u32(root, 8) == 0, "ROOT: entry 0");
    require(u64(root, 12 * groups) == data.offset + data.bytes.size(), "ROOT: end of DATA");
    require(u32(root, 12 * groups + 8) == index.bytes.size(), "ROOT: end of INDX");

    std::vector<Bytes> tiles(levels.back().first_tile + levels.back().tiles);
    for (uint64_t g = 0; g < groups; ++g) {
        const uint64_t begin = u64(root, 12 * g), end = u64(root, 12 * g + 12);
        const uint32_t record_begin = u32(root, 12 * g + 8);
        const uint32_t record_end = u32(root, 12 * g + 20);
        require(begin <= end && end <= data.offset + data.bytes.size(), "ROOT: data offsets");
        require(record_begin < record_end && record_end <= index.bytes.size(),
                "ROOT: record offsets");
        const Bytes record = index.bytes.subspan(record_begin, record_end - record_begin);
        require(record.size() >= 4, "index record: cut short");
        const Bytes body = record.first(record.size() - 4);
        const Seed seed = Seed().add(header.identity, 8).add(g, 4);
        require(crc32c(body, crc32c(seed.bytes)) == u32(record, body.size()), "record_crc");

        const auto [first_tile, n] = group_tiles[g];
        size_t used = 0;
        const std::vector<uint64_t> lengths = read_lengths(body, n, used);
        uint64_t sum = 0;
        for (uint64_t length : lengths) {
            require(length <= longest, "index record: a tile too long");
            sum += length;
        }
        require(sum == end - begin, "index record: lengths must add up");

        const std::vector<uint64_t> pages = page_sizes(lengths, header.page_target);
        require(body.size() == used + 4 * pages.size(), "index record: size");
        uint64_t at = begin;
        for (size_t page = 0; page < pages.size(); ++page) {
            const Seed page_seed = Seed().add(header.identity, 8).add(g, 4).add(page, 4);
            const uint32_t crc = crc32c(file.subspan(at, pages[page]), crc32c(page_seed.bytes));
            require(crc == u32(body, used + 4 * page), "page_crc");
            at += pages[page];
        }
        at = begin;
        for (size_t i = 0; i < n; ++i) {
            tiles[first_tile + i] = file.subspan(at, lengths[i]);
            at += lengths[i];
        }
    }
    return tiles;
}

// --------------------------------------------------------------------------- 3.3 the entropy coder

// c[0] = 0 < c[1] < ... < c[m] = 4096
using Table = std::vector<uint32_t>;

class Stream {
public:
    Stream() : Stream(Bytes{}) {}
    explicit Stream(Bytes bytes) : bytes_(bytes) {
        require(bytes.size() % 2 == 0, "stream: odd length");
        refill();
        refill();
    }
    int symbol(const Table& c) {
        const uint32_t r = x_ % 4096;
        size_t i = 0;
        while (c[i + 1] <= r)
            ++i;
        x_ = (c[i + 1] - c[i]) * (x_ / 4096) + r - c[i];
        refill();
        return static_cast<int>(i);
    }
    bool bit(uint32_t f) {
        const uint32_t r = x_ % 4096;
        const bool one = r >= f;
        x_ = one ? (4096 - f) * (x_ / 4096) + r - f : f * (x_ / 4096) + r;
        refill();
        return one;
    }
    uint32_t raw(int n) {
        const uint32_t value = x_ & ((1u << n) - 1);
        x_ >>= n;
        refill();
        return value;
    }
    bool ends_well() const { return x_ == 0 && at_ == bytes_.size(); }

private:
    void refill() {
        if (x_ < 65536 && at_ < bytes_.size()) {
            x_ = x_ * 65536 + u16(bytes_, at_);
            at_ += 2;
        }
    }

    Bytes bytes_;
    size_t at_ = 0;
    uint32_t x_ = 0;
};

// ------------------------------------------------------------------------------------ 3.5 CODE

constexpr uint8_t default_parameter_list[] = {
#include "tests/reference/default_parameters.inc"
};
constexpr size_t parameter_count = 5809;
static_assert(std::size(default_parameter_list) == parameter_count);

struct Step {
    int64_t m = 0;
    int e = 0;
};

struct Ring { // of the filter
    int strength = 0, reach = 1;
};

struct Code {
    std::array<Step, 4> step;
    Step rotated_step;
    int offset[2][2]; // [plane 0, others][magnitude 1, larger]
    std::array<int, 4> scan_weight;
    int64_t correction_error = 0;
    bool has_colour_symbols = false;
    bool has_predictions = false;
    bool dependent = false;
    bool smooth_copies = false;
    std::optional<int> base_margin; // of files with base pictures
    bool v_against_u = false;
    std::optional<std::array<std::array<Ring, 3>, 2>> filter; // [plane 0, others][ring]

    uint32_t zero[2][2][7][6][16]; // frequencies of 0
    Table magnitude[2][2][66];
    Table first_length[18];
    Table other_length[14];
    Table split[6][6];
    Table correction[21];
    Table colour[2];
    Table prediction[6];
    Table displacement_kind[2];
    Table displacement[2];
    Table base;
    Table from_base[2];
    Table base_displacement;
};

uint32_t frequency(int p) {
    const double exact = 4096 / (1 + std::exp2((p - 32) / 3.0));
    return static_cast<uint32_t>(std::clamp(std::lround(exact), 1l, 4095l));
}

// A table of m symbols from its chain of parameters.
Table make_table(std::span<const int> chain, int m) {
    Table c;
    int s = 0;
    for (int i = 0; i <= m - 2; ++i) {
        c.push_back(static_cast<uint32_t>(s));
        const int left = 4096 - s;
        const int p = chain[std::min(static_cast<size_t>(i), chain.size() - 1)];
        const int share = left * static_cast<int>(frequency(p)) / 4096;
        s += std::clamp(share, 1, left - (m - 1 - i));
    }
    c.push_back(static_cast<uint32_t>(s));
    c.push_back(4096);
    return c;
}

Code read_code(Bytes section) {
    require(section.size() >= 24, "CODE: cut short");
    Code code;
    const auto read_step = [&](size_t at) {
        const uint16_t value = u16(section, at);
        require(value >> 11 <= 20, "CODE: step");
        return Step{value & 2047, value >> 11};
    };
    for (size_t p = 0; p < 4; ++p)
        code.step[p] = read_step(2 * p);
    code.rotated_step = read_step(8);
    for (size_t i = 0; i < 4; ++i) {
        const int offset = u8(section, 10 + i);
        require(offset <= 31, "CODE: reconstruction offset");
        code.offset[i / 2][i % 2] = offset;
    }
    for (size_t a = 0; a < 4; ++a) {
        code.scan_weight[a] = u8(section, 14 + a);
        require(code.scan_weight[a] >= 1, "CODE: scan weight");
    }
    code.correction_error = u16(section, 18);
    uint32_t d[3];
    for (size_t i = 0; i < 3; ++i) {
        require(u8(section, 20 + i) <= 63, "CODE: difference model");
        d[i] = frequency(u8(section, 20 + i));
    }
    const int flags = u8(section, 23);
    require(flags <= 127, "CODE: flags");
    code.has_colour_symbols = flags & 1;
    code.has_predictions = flags >> 1 & 1;
    code.dependent = flags & 4;
    code.smooth_copies = flags & 8;
    require(code.has_predictions || !code.smooth_copies, "CODE: flag 3 without flag 1");

    size_t at = 24;
    code.v_against_u = flags & 64;
    if (flags & 32) {
        require(section.size() > at, "CODE: cut short");
        code.base_margin = u8(section, at++);
        require(*code.base_margin <= 31, "CODE: margin");
    }
    require(code.has_predictions || !code.base_margin, "CODE: flag 5 without flag 1");
    require(code.base_margin || !code.v_against_u, "CODE: flag 6 without flag 5");
    if (flags & 16) {
        require(section.size() >= at + 12, "CODE: cut short");
        code.filter.emplace();
        bool does_something = false;
        for (auto& rings : *code.filter)
            for (Ring& ring : rings) {
                ring.strength = static_cast<int8_t>(u8(section, at++));
                ring.reach = u8(section, at++);
                require(ring.strength != -128 && ring.reach != 0, "CODE: filter");
                does_something = does_something || ring.strength != 0;
            }
        require(does_something, "CODE: a filter of strength 0");
    }

    // The differences to the defaults.
    Stream stream(section.subspan(at));
    std::vector<int> parameters;
    bool differed = false;
    for (const int default_value : default_parameter_list) {
        int value = default_value;
        const size_t i = parameters.size();
        // Those of copying blocks: half of zero, magnitude and first_length, and all from prediction on.
        const bool of_copies = (i >= 1344 && i < 2688) || (i >= 3876 && i < 5064) ||
                               (i >= 5181 && i < 5298) || i >= 5766;
        const bool of_bases = i >= 5798;
        if ((of_copies && !code.has_predictions) || (of_bases && !code.base_margin)) {
            parameters.push_back(value);
            continue;
        }
        differed = stream.bit(differed ? d[1] : d[0]);
        if (differed) {
            int difference = 1;
            while (difference < 63 && stream.bit(d[2]))
                ++difference;
            value += stream.raw(1) ? -difference : difference;
            require(value >= 0 && value <= 63, "CODE: parameter");
        }
        parameters.push_back(value);
    }
    require(stream.ends_well(), "CODE: the stream must end well");

    // The tables, in the order of the parameters.
    std::span<const int> rest = parameters;
    const auto table = [&](size_t chain, int symbols) {
        const Table result = make_table(rest.first(chain), symbols);
        rest = rest.subspan(chain);
        return result;
    };
    for (auto& of_copies : code.zero)
        for (auto& quantiser : of_copies)
            for (auto& row : quantiser)
                for (auto& position : row)
                    for (uint32_t& f : position) {
                        f = frequency(rest[0]);
                        rest = rest.subspan(1);
                    }
    for (auto& of_copies : code.magnitude)
        for (auto& of_quantiser : of_copies)
            for (Table& t : of_quantiser)
                t = table(9, 24);
    for (Table& t : code.first_length)
        t = table(13, 14);
    for (Table& t : code.other_length)
        t = table(13, 14);
    for (auto& of_depth : code.split)
        for (Table& t : of_depth)
            t = table(2, 3);
    for (Table& t : code.correction)
        t = table(10, 25);
    for (Table& t : code.colour)
        t = table(2, 3);
    for (Table& t : code.prediction)
        t = table(2, 3);
    for (Table& t : code.displacement_kind)
        t = table(2, 3);
    for (Table& t : code.displacement)
        t = table(8, 9);
    code.base = table(1, 2);
    for (Table& t : code.from_base)
        t = table(1, 2);
    code.base_displacement = table(8, 9);
    return code;
}

// ------------------------------------------------------------------------------ 3.2 the payload

struct Segment {
    size_t first_block = 0;
    Bytes bytes;
};

struct Payload {
    std::vector<Segment> segments;
    std::vector<std::optional<Bytes>> corrections; // one a chunk
};

Payload read_payload(Bytes bytes, const Header& header, size_t chunk_count) {
    Payload payload;
    payload.corrections.resize(chunk_count);
    payload.segments.push_back({0, {}});
    std::vector<size_t> lengths;            // of the further segments, in bytes
    std::vector<size_t> correction_lengths; // in bytes
    size_t at = 0;
    uint32_t mask = 0;
    if (bytes.size() % 2 == 1) {
        const int first = u8(bytes, 0);
        at = 1;
        for (int i = 0; i < (first & 127); ++i) {
            const size_t first_block = u16(bytes, at);
            require(i == 0 || first_block > payload.segments.back().first_block,
                    "payload: first blocks must ascend");
            payload.segments.push_back({first_block, {}});
            lengths.push_back(size_t{2} * u16(bytes, at + 2));
            at += 4;
        }
        if (first & 128) {
            require(header.has_corrections(), "payload: corrections without their feature");
            mask = u16(bytes, at);
            at += 2;
            require(mask >> chunk_count == 0, "payload: a chunk that the tile does not have");
            for (int i = 0; i < std::popcount(mask); ++i) {
                correction_lengths.push_back(size_t{2} * u16(bytes, at));
                require(correction_lengths.back() > 0, "payload: empty correction stream");
                at += 2;
            }
        }
    }
    size_t others = at;
    for (size_t length : lengths)
        others += length;
    for (size_t length : correction_lengths)
        others += length;
    require(others <= bytes.size(), "payload: lengths must fit");

    const auto take = [&](size_t length) {
        const Bytes part = bytes.subspan(at, length);
        at += length;
        return part;
    };
    payload.segments[0].bytes = take(bytes.size() - others);
    for (size_t i = 0; i < lengths.size(); ++i)
        payload.segments[i + 1].bytes = take(lengths[i]);
    size_t next = 0;
    for (size_t chunk = 0; chunk < chunk_count; ++chunk)
        if (mask >> chunk & 1)
            payload.corrections[chunk] = take(correction_lengths[next++]);
    return payload;
}

// --------------------------------------------------------------------------------- 3.4 the blocks

using Vector4 = std::array<int, 4>; // u, v, s, t

int product(const Vector4& n) {
    return n[0] * n[1] * n[2] * n[3];
}

// ((t * ns + s) * nv + v) * nu + u
size_t place(const Vector4& at, const Vector4& n) {
    return static_cast<size_t>(((at[3] * n[2] + at[2]) * n[1] + at[1]) * n[0] + at[0]);
}

struct Coefficient {
    Vector4 k;
    int cost;
    int position;
    size_t where; // place(k, n)
};
using Scan = std::vector<Coefficient>;

// How many frequencies of an axis of n texels are coded.
int coded_frequencies(int n) {
    return std::min(n, 32);
}

Scan make_scan(const Vector4& n, const std::array<int, 4>& weight) {
    Scan scan;
    for (int t = 0; t < coded_frequencies(n[3]); ++t)
        for (int s = 0; s < coded_frequencies(n[2]); ++s)
            for (int v = 0; v < coded_frequencies(n[1]); ++v)
                for (int u = 0; u < coded_frequencies(n[0]); ++u) {
                    const Vector4 k{u, v, s, t};
                    int cost = 0;
                    for (size_t a = 0; a < 4; ++a)
                        cost += weight[a] * k[a] * 8 / n[a];
                    scan.push_back({k, cost, 0, place(k, n)});
                }
    // The order of the loops is ascending in `where`.
    std::stable_sort(scan.begin(), scan.end(),
                     [](const Coefficient& a, const Coefficient& b) { return a.cost < b.cost; });
    scan.resize(std::min<size_t>(scan.size(), 4096));
    for (size_t i = 0; i < scan.size(); ++i)
        scan[i].position = i == 0 ? 0 : std::min(1 + scan[i].cost / 96, 5);
    return scan;
}

struct Block {
    Vector4 begin; // in the tile, or in its base picture
    Vector4 size;
    bool of_base = false;
    bool copies_base = false;
    int rotation = -1;                  // -1: plain
    std::optional<size_t> copies_along; // 0 s, 1 t
    std::array<int, 2> displacement{};  // du, dv, where it copies
    int depth = -1;                     // 4.6; -1: not known yet
    bool copies() const { return copies_along.has_value() || copies_base; }
    // Levels in scan order, a vector as long as the coded length for each plane.
    std::array<std::vector<int32_t>, 4> levels;
};

// The magnitude that starts with token q; used by levels and corrections.
int64_t read_magnitude(Stream& stream, int q) {
    if (q < 4)
        return q + 1;
    const int g = q - 3;
    int64_t h = 0;
    if (g > 16)
        h = stream.raw(g - 16);
    const int64_t l = stream.raw(std::min(g, 16));
    return (int64_t{1} << g) + h * 65536 + l + 3;
}

class TileDecoder {
public:
    TileDecoder(const Header& header, const Code& code) : header_(header), code_(code) {}

    // The samples of the tile, in the order of part 2.
    std::vector<uint16_t> decode(Bytes bytes, const Vector4& size);

private:
    void read_split_tree(Stream& stream, const Vector4& begin, const Vector4& size, int a, int b,
                         bool of_base = false);
    void read_base_tree(Stream& stream);
    int read_difference(Stream& stream, const Table& table);
    std::array<int64_t, 4> predicted_from_base(const Block& block, const Vector4& in_tile) const;
    void read_prediction(Stream& stream, Block& block);
    int depth_of(Block& block);
    std::array<int64_t, 4> predicted(const Block& block, const Vector4& at) const;
    void read_segment(Stream& stream, size_t begin, size_t end, int64_t work);
    void read_plane(Stream& stream, Block& block, int plane, int length);
    const Scan& scan_of(const Vector4& n);
    void reconstruct(const Block& block);
    void filter();
    void make_codes();
    int G() const { return header_.sample_type == 0 ? 4 : 0; } // fraction bits of values
    int64_t value_limit() const { return header_.sample_type == 0 ? 16384 : 262144; }
    void add_corrections(const Payload& payload);
    size_t texel_number(const Vector4& at) const { // part 2
        return static_cast<size_t>(((at[1] * size_[0] + at[0]) * size_[3] + at[3]) * size_[2] +
                                   at[2]);
    }

    const Header& header_;
    const Code& code_;
    std::map<Vector4, Scan> scans_;

    Vector4 size_{};
    std::vector<Block> blocks_;
    int64_t nodes_ = 0;
    bool last_block_copied_ = false; // of those with a prediction symbol
    bool has_base_ = false, last_copied_base_ = false;
    int last_base_displacement_ = 0;
    Vector4 base_size_{};
    std::array<std::vector<int64_t>, 4> base_values_;
    std::array<std::array<std::array<int, 2>, 2>, 2>
        displacement_{}; // [direction][last, the one before]
    bool predicted_tile_ = false;
    std::array<std::vector<int64_t>, 4> plane_values_; // by place() in the tile
    // Per plane: codes of the amplitudes of the coefficients decoded so far, by place(); -1 before.
    std::array<std::vector<int>, 4> amplitude_;
    // Codes, texel by texel as part 2 numbers them, channels adjacent.
    std::vector<int64_t> codes_;
};

const Scan& TileDecoder::scan_of(const Vector4& n) {
    const auto found = scans_.find(n);
    return found != scans_.end() ? found->second : (scans_[n] = make_scan(n, code_.scan_weight));
}

// 3.4. The tile's base picture, if it can have one and does.
void TileDecoder::read_base_tree(Stream& stream) {
    if (!code_.base_margin || size_[2] * size_[3] < 4)
        return;
    base_size_ = {size_[0] + 2 * *code_.base_margin, size_[1] + 2 * *code_.base_margin, 1, 1};
    if (base_size_[0] > 64 || base_size_[1] > 64)
        return;
    has_base_ = stream.symbol(code_.base) == 1;
    if (has_base_)
        read_split_tree(stream, {0, 0, 0, 0}, base_size_, 0, 5, true);
}

void TileDecoder::read_split_tree(Stream& stream, const Vector4& begin, const Vector4& size, int a,
                                  int b, bool of_base) {
    ++nodes_;
    const int split = stream.symbol(code_.split[std::min(a, 5)][std::min(b, 5)]);
    if (split == 0) {
        require(blocks_.size() < 4096, "tile: too many blocks");
        blocks_.push_back({begin, size, of_base, false, -1, {}, {}, -1, {}});
        if (code_.has_predictions && !of_base)
            read_prediction(stream, blocks_.back());
        return;
    }
    const size_t first = split == 1 ? 0 : 2, second = first + 1;
    require(size[first] > 1 || size[second] > 1, "tile: a split must divide a side");
    // Part 0 and part 1 of an axis; part 1 of a side of 1 is not there.
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            Vector4 child_begin = begin, child_size = size;
            for (const auto& [axis, part] : {std::pair{first, i}, std::pair{second, j}}) {
                const int half = (size[axis] + 1) / 2;
                child_begin[axis] += part == 0 ? 0 : half;
                child_size[axis] = part == 0 ? half : size[axis] - half;
            }
            if (product(child_size) > 0)
                read_split_tree(stream, child_begin, child_size, a + (split == 1), b + (split == 2),
                                of_base);
        }
}

int TileDecoder::read_difference(Stream& stream, const Table& table) {
    const int k = stream.symbol(table);
    if (k == 0)
        return 0;
    const int m = static_cast<int>(stream.raw(k - 1));
    const int magnitude = (1 << (k - 1)) + m;
    return stream.raw(1) ? -magnitude : magnitude;
}

void TileDecoder::read_prediction(Stream& stream, Block& block) {
    if (has_base_) {
        block.copies_base = stream.symbol(code_.from_base[last_copied_base_]) == 1;
        last_copied_base_ = block.copies_base;
        if (block.copies_base) {
            last_base_displacement_ += read_difference(stream, code_.base_displacement);
            require(std::abs(last_base_displacement_) <= 127, "tile: displacement");
            const int d = last_base_displacement_;
            block.displacement = {d, code_.v_against_u ? -d : d};
            return;
        }
    }
    const bool s_before = block.begin[2] > 0, t_before = block.begin[3] > 0;
    if (!s_before && !t_before)
        return;
    const int w = !t_before ? 0 : !s_before ? 1 : 2;
    const int symbol = stream.symbol(code_.prediction[2 * w + last_block_copied_]);
    require(w == 2 || symbol <= 1, "tile: prediction symbol");
    last_block_copied_ = symbol != 0;
    if (symbol == 0)
        return;
    const size_t direction = w == 1 || symbol == 2 ? 1 : 0;
    auto& known = displacement_[direction];
    const int kind = stream.symbol(code_.displacement_kind[direction]);
    std::array<int, 2> d = known[kind == 1 ? 1 : 0];
    if (kind == 2)
        for (size_t component = 0; component < 2; ++component) {
            d[component] +=
                read_difference(stream, code_.displacement[component == direction ? 0 : 1]);
            require(std::abs(d[component]) <= 127, "tile: displacement");
        }
    if (d != known[0]) {
        known[1] = known[0];
        known[0] = d;
    }
    block.copies_along = direction;
    block.displacement = d;
}

// 4.6. What a block copies from lies earlier along the angular splits, so the recursion ends.
int TileDecoder::depth_of(Block& block) {
    if (block.depth >= 0)
        return block.depth;
    int depth = 0;
    if (block.copies_base) {
        depth = 1;
    } else if (block.copies()) {
        const size_t axis = 2 + *block.copies_along, other = 3 - *block.copies_along;
        for (Block& from : blocks_)
            if (!from.of_base && from.begin[axis] < block.begin[axis] &&
                from.begin[axis] + from.size[axis] >= block.begin[axis] &&
                from.begin[other] < block.begin[other] + block.size[other] &&
                from.begin[other] + from.size[other] > block.begin[other])
                depth = std::max(depth, 1 + depth_of(from));
    }
    require(depth <= 15, "tile: depth of copies");
    return block.depth = depth;
}

// The prediction of a texel of the tile that is in a block that copies the base picture.
std::array<int64_t, 4> TileDecoder::predicted_from_base(const Block& block,
                                                        const Vector4& in_tile) const {
    static const int W[8][6] = {{0, 0, 64, 0, 0, 0},    {1, -5, 62, 8, -2, 0},
                                {2, -9, 58, 17, -4, 0}, {2, -9, 49, 28, -7, 1},
                                {2, -9, 39, 39, -9, 2}, {1, -7, 28, 49, -9, 2},
                                {0, -4, 17, 58, -9, 2}, {0, -2, 8, 62, -5, 1}};
    const int x = (in_tile[2] - (size_[2] - 1) / 2) * block.displacement[0];
    const int y = (in_tile[3] - (size_[3] - 1) / 2) * block.displacement[1];
    const int m = *code_.base_margin;
    const auto i = static_cast<int>(in_tile[0] + m + floor_div(x, 8)),
               j = static_cast<int>(in_tile[1] + m + floor_div(y, 8));
    const auto f = static_cast<size_t>(x - 8 * floor_div(x, 8)),
               g = static_cast<size_t>(y - 8 * floor_div(y, 8));
    std::array<int64_t, 4> result{};
    for (size_t p = 0; p < static_cast<size_t>(header_.channels); ++p) {
        const auto R = [&](int b) {
            int64_t sum = 2;
            for (int a = 0; a < 6; ++a) {
                const Vector4 at = {std::clamp(i + a - 2, 0, base_size_[0] - 1),
                                    std::clamp(b, 0, base_size_[1] - 1), 0, 0};
                sum += W[f][a] * base_values_[p][place(at, base_size_)];
            }
            return floor_div(sum, 4);
        };
        int64_t sum = 512;
        for (int b = 0; b < 6; ++b)
            sum += W[g][b] * R(j + b - 2);
        result[p] = floor_div(sum, 1024);
    }
    return result;
}

// The prediction of a texel, in place `at` of a block that copies from another view.
std::array<int64_t, 4> TileDecoder::predicted(const Block& block, const Vector4& at) const {
    std::array<int64_t, 4> sums{};
    const size_t direction = *block.copies_along;
    const int k = at[2 + direction] + 1;
    const int x = 2 * (block.begin[0] + at[0]) + k * block.displacement[0];
    const int y = 2 * (block.begin[1] + at[1]) + k * block.displacement[1];
    Vector4 from{};
    for (size_t a = 2; a < 4; ++a)
        from[a] = a == 2 + direction ? block.begin[a] - 1 : block.begin[a] + at[a];
    const auto i = static_cast<int>(floor_div(x, 2)), j = static_cast<int>(floor_div(y, 2));
    const int f = x - 2 * i, g = y - 2 * j;
    const auto add = [&](int weight, int a, int b) {
        from[0] = std::clamp(a, 0, size_[0] - 1);
        from[1] = std::clamp(b, 0, size_[1] - 1);
        for (size_t p = 0; p < static_cast<size_t>(header_.channels); ++p)
            sums[p] += weight * plane_values_[p][place(from, size_)];
    };
    if (!code_.smooth_copies) {
        for (int b = 0; b < 2; ++b)
            for (int a = 0; a < 2; ++a)
                add((a == 0 ? 2 - f : f) * (b == 0 ? 2 - g : g), i + a, j + b);
    } else if (f == 0 && g == 0) {
        add(8, i, j);
        for (const int step : {-1, 1}) {
            add(2, i + step, j);
            add(2, i, j + step);
        }
    } else if (f == 1 && g == 1) {
        for (const int b : {j, j + 1})
            for (const int a : {i, i + 1})
                add(4, a, b);
    } else {
        for (const int half : {0, 1})
            for (const int step : {-1, 0, 1})
                add(step == 0 ? 6 : 1, i + (f == 1 ? half : step), j + (f == 1 ? step : half));
    }
    const int parts = code_.smooth_copies ? 16 : 4;
    for (int64_t& sum : sums)
        sum = floor_div(sum + parts / 2, parts);
    return sums;
}

void TileDecoder::read_segment(Stream& stream, size_t begin, size_t end, int64_t work) {
    bool last_was_rotated = false;
    int last_rotation = 0;
    for (size_t number = begin; number < end; ++number) {
        Block& block = blocks_[number];
        const int texels = product(block.size);
        int first_token = 0;
        for (int plane = 0; plane < header_.channels; ++plane) {
            // 1. The length token.
            int k = 0;
            if (plane == 0) {
                const int b = std::bit_width(static_cast<uint32_t>(texels));
                k = stream.symbol(
                    code_.first_length[std::min(b / 2, 8) + (block.copies() ? 9 : 0)]);
                first_token = k;
            } else {
                k = stream.symbol(code_.other_length[first_token]);
            }
            int length = 0;
            if (k > 0) {
                const int e = std::min(k - 1, 2);
                const int m = static_cast<int>(stream.raw(e));
                length = std::min((1 << (k - 1)) + (m << (k - 1 - e)),
                                  static_cast<int>(scan_of(block.size).size()));
            }
            work += 1 + length;
            require(work <= 16000, "tile: the work of a segment");

            // 2. The colour.
            if (plane == 0 && length > 0 && code_.has_colour_symbols && header_.channels >= 3) {
                const int colour = stream.symbol(code_.colour[last_was_rotated]);
                if (colour == 1)
                    block.rotation = last_rotation;
                if (colour == 2) {
                    block.rotation = static_cast<int>(stream.raw(6));
                    require(block.rotation < 49, "tile: rotation");
                    last_rotation = block.rotation;
                }
                last_was_rotated = colour != 0;
            }

            // 3. The coefficients.
            read_plane(stream, block, plane, length);
        }
    }
}

int amplitude_code(int64_t x) {
    if (x < 2)
        return static_cast<int>(x);
    const int n = std::bit_width(static_cast<uint64_t>(x));
    return std::min(2 * (n - 1) + static_cast<int>(x >> (n - 2) & 1), 15);
}

int amplitude_value(int code) {
    static constexpr int values[] = {0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192};
    return values[code];
}

void TileDecoder::read_plane(Stream& stream, Block& block, int plane, int length) {
    // Steps from a neighbour to the coefficient.
    struct Neighbour {
        Vector4 step;
        int weight;
    };
    static constexpr Neighbour neighbour_list[] = {
        {{1, 0, 0, 0}, 2},  {{0, 1, 0, 0}, 2},  {{0, 0, 1, 0}, 2},  {{0, 0, 0, 1}, 2},
        {{1, 0, 1, 0}, 1},  {{1, 0, -1, 0}, 1}, {{-1, 0, 1, 0}, 1}, {{0, 1, 0, 1}, 1},
        {{0, 1, 0, -1}, 1}, {{0, -1, 0, 1}, 1}, {{1, 1, 0, 0}, 1},  {{0, 0, 1, 1}, 1}};
    static constexpr int after_even[] = {0, 5, 1, 6, 2, 4, 3, 7};
    static constexpr int after_odd[] = {2, 7, 3, 4, 0, 6, 1, 5};

    const Scan& scan = scan_of(block.size);
    std::vector<int>& amplitude = amplitude_[static_cast<size_t>(plane)];
    amplitude.assign(static_cast<size_t>(product(block.size)), -1);
    std::vector<int32_t>& levels = block.levels[static_cast<size_t>(plane)];
    int state = 0;
    for (size_t i = 0; i < static_cast<size_t>(length); ++i) {
        const Coefficient& coefficient = scan[i];
        const int B = block.copies() ? 1 : 0;
        const int Q = code_.dependent ? state % 2 : 0;
        int w = 0, S = 0;
        for (const Neighbour& neighbour : neighbour_list) {
            Vector4 from{};
            bool inside = true;
            for (size_t a = 0; a < 4; ++a) {
                from[a] = coefficient.k[a] - neighbour.step[a];
                inside = inside && from[a] >= 0 && from[a] < block.size[a];
            }
            if (inside && amplitude[place(from, block.size)] >= 0) {
                w += neighbour.weight;
                S += neighbour.weight * amplitude_value(amplitude[place(from, block.size)]);
            }
        }
        const int neighbours = i == 0 ? std::min(static_cast<int>(std::bit_width(
                                                     static_cast<uint32_t>(product(block.size)))) /
                                                     2,
                                                 8)
                                      : amplitude_code(S * (4096 / w) / 512);
        int cross = 0;
        for (size_t p = 0; p < static_cast<size_t>(plane); ++p)
            cross = amplitude_code(amplitude_value(cross) +
                                   amplitude_value(std::max(amplitude_[p][coefficient.where], 0)));
        const int K = std::min((cross + 1) / 2, 5);
        const int row = plane == 0 ? 0 : 1 + K;

        int64_t magnitude = 0, level = 0;
        if (stream.bit(code_.zero[B][Q][row][coefficient.position][neighbours])) {
            int m = i == 0 ? 16 + neighbours : neighbours;
            if (plane > 0)
                m = i == 0 ? 57 + neighbours : 25 + 4 * (neighbours / 2) + std::max(K - 2, 0);
            const int q = stream.symbol(code_.magnitude[B][Q][m]);
            magnitude = read_magnitude(stream, q);
            level = code_.dependent ? 2 * magnitude - Q : magnitude;
            require(level <= (1 << 20) - 1, "tile: a level's magnitude");
        }
        amplitude[coefficient.where] = amplitude_code(code_.dependent ? level : 2 * level);
        if (magnitude > 0 && stream.raw(1))
            level = -level;
        levels.push_back(static_cast<int32_t>(level));
        state = magnitude % 2 == 0 ? after_even[state] : after_odd[state];
    }
}

// ------------------------------------------------------------------------------- 4.1 dequantisation

// M and x for one number z of frequencies above 0.
struct Scale {
    int64_t M = 0;
    int x = 0;
};

uint64_t floor_sqrt(uint64_t a) {
    uint64_t root = 0;
    for (int bit = 31; bit >= 0; --bit) {
        const uint64_t larger = root | 1ull << bit;
        if (larger * larger <= a)
            root = larger;
    }
    return root;
}

Scale make_scale(const Step& step, int N, int z, int F, bool dependent) {
    using Wide = unsigned __int128;
    const Wide square = static_cast<Wide>((2048 + step.m) * (2048 + step.m));
    const uint64_t A = static_cast<uint64_t>((square << (z + 36)) / static_cast<unsigned>(N));
    const uint64_t R = floor_sqrt(A);
    int h = std::bit_width(R) - 11;
    int64_t M = static_cast<int64_t>((R + (1ull << (h - 1))) >> h);
    if (M == 2048) {
        M = 1024;
        ++h;
    }
    return {M, h + step.e - 12 + F - 18 - (dependent ? 1 : 0)};
}

int64_t dequantise(int64_t level, const Scale& scale, int offset) {
    if (level == 0)
        return 0;
    const int64_t P = std::abs(level) * scale.M - scale.M * offset / 64;
    int64_t value = 0;
    if (scale.x < -31)
        value = 0;
    else if (scale.x < 0)
        value = (P + (int64_t{1} << (-scale.x - 1))) >> -scale.x;
    else
        value = P << scale.x;
    value = std::min(value, int64_t{1} << 26);
    return level < 0 ? -value : value;
}

// ----------------------------------------------------------------- 4.2, 4.3 basis, inverse transform

struct Basis {
    int32_t b[65][32][64]; // [n][k][x]
    Basis() {
        for (int n = 1; n <= 64; ++n)
            for (int k = 0; k < coded_frequencies(n); ++k)
                for (int x = 0; x < n; ++x)
                    b[n][k][x] = static_cast<int32_t>(std::lround(
                        32768 * std::cos((2 * x + 1) * k * std::numbers::pi / (2 * n))));
    }
};

// One line: `values` at distance `stride` of each other.
void inverse_line(int64_t* values, int n, size_t stride) {
    static const Basis basis;
    uint32_t H[64] = {}, L[64] = {}; // modulo 2^32
    for (int k = 0; k < coded_frequencies(n); ++k) {
        const int64_t in = std::clamp(values[static_cast<size_t>(k) * stride], -(int64_t{1} << 26),
                                      (int64_t{1} << 26) - 1);
        if (in == 0)
            continue;
        const auto high = static_cast<uint32_t>(in >> 11);
        const auto low = static_cast<uint32_t>(in & 2047);
        const int32_t* row = basis.b[n][k];
        for (int x = 0; x < n; ++x) {
            H[x] += static_cast<uint32_t>(row[x]) * high;
            L[x] += static_cast<uint32_t>(row[x]) * low;
        }
    }
    for (int x = 0; x < n; ++x) {
        const int64_t rounded = floor_div(int64_t{static_cast<int32_t>(L[x])} + (1 << 14), 1 << 11);
        const auto sum = static_cast<int32_t>(H[x] + static_cast<uint32_t>(rounded));
        values[static_cast<size_t>(x) * stride] = sum >> 4;
    }
}

// `values` by place(); the four passes and the last rounding.
// Values come out in 2^-(F - bits) of a code.
void inverse_transform(std::vector<int64_t>& values, const Vector4& n, int bits) {
    size_t stride = 1;
    for (size_t axis = 0; axis < 4; ++axis) {
        const size_t side = static_cast<size_t>(n[axis]);
        if (side > 1)
            for (size_t outer = 0; outer < values.size(); outer += stride * side)
                for (size_t inner = 0; inner < stride; ++inner)
                    inverse_line(&values[outer + inner], n[axis], stride);
        stride *= side;
    }
    for (int64_t& value : values)
        value = (value + (int64_t{1} << (bits - 1))) >> bits;
}

// -------------------------------------------------------------------------------- 4.4 rotated colour

using Matrix = std::array<std::array<int64_t, 3>, 3>; // [row][column]
using Real = long double;
using Real3 = std::array<Real, 3>;

Real3 normalised(const Real3& v) {
    const Real length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return {v[0] / length, v[1] / length, v[2] / length};
}

Real3 cross_product(const Real3& a, const Real3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::vector<Matrix> make_rotations() {
    std::vector<Matrix> rotations;
    for (int r = -2; r <= 2; ++r)
        for (int g = -2; g <= 2; ++g)
            for (int b = -2; b <= 2; ++b) {
                const bool all_even = r % 2 == 0 && g % 2 == 0 && b % 2 == 0;
                const int first = r != 0 ? r : g != 0 ? g : b;
                if (all_even || first <= 0)
                    continue;
                const int direction[3] = {r, g, b};
                size_t least = 0;
                for (size_t i = 1; i < 3; ++i)
                    if (std::abs(direction[i]) < std::abs(direction[least]))
                        least = i;
                Real3 unit{};
                unit[least] = 1;
                Real3 d[3];
                d[0] =
                    normalised({static_cast<Real>(r), static_cast<Real>(g), static_cast<Real>(b)});
                d[1] = normalised(cross_product(d[0], unit));
                d[2] = cross_product(d[0], d[1]);
                Matrix Q;
                for (size_t j = 0; j < 3; ++j) {
                    const auto& [dr, dg, db] = d[j];
                    // std::llround rounds ties away from zero.
                    Q[0][j] = std::llround(4096 * ((dr + 2 * dg + db) / 4));
                    Q[1][j] = std::llround(4096 * (dr - db));
                    Q[2][j] = std::llround(4096 * (dg - (dr + db) / 2));
                }
                rotations.push_back(Q);
            }
    return rotations; // 49 in ascending lexicographic order
}

std::array<int64_t, 3> rotate(const Matrix& Q, const std::array<int64_t, 3>& x) {
    std::array<int64_t, 3> result{};
    for (size_t i = 0; i < 3; ++i) {
        int64_t H = 0, L = 0;
        for (size_t j = 0; j < 3; ++j) {
            H += Q[i][j] * (x[j] >> 11);
            L += Q[i][j] * (x[j] & 2047);
        }
        result[i] = floor_div(H + floor_div(L + (1 << 11), 1 << 11), 2);
    }
    return result;
}

// ------------------------------------------------------------------------------ 4.5 codes and samples

int64_t code_of(uint16_t sample, int sample_type) {
    if (sample_type == 0)
        return sample;
    const int64_t low = sample & 0x7FFF;
    return sample & 0x8000 ? -low : low;
}

int64_t clamp_code(int64_t code, int sample_type) {
    return sample_type == 0 ? std::clamp<int64_t>(code, 0, 255)
                            : std::clamp<int64_t>(code, -31743, 31743);
}

uint16_t sample_of(int64_t code, int sample_type) {
    if (sample_type == 0 || code >= 0)
        return static_cast<uint16_t>(code);
    return static_cast<uint16_t>(0x8000 | -code);
}

// The planes of a texel from the codes of its channels.
std::array<int64_t, 4> to_planes(std::array<int64_t, 4> x, int colour) {
    if (colour == 0)
        return x;
    const int64_t R = x[0], G = x[1], B = x[2];
    const int64_t Co = R - B, t = B + (Co >> 1), Cg = G - t, Y = t + (Cg >> 1);
    return {Y, Co, Cg, x[3]};
}

std::array<int64_t, 4> from_planes(std::array<int64_t, 4> x, int colour) {
    if (colour == 0)
        return x;
    const int64_t Y = x[0], Co = x[1], Cg = x[2];
    const int64_t t = Y - (Cg >> 1), G = Cg + t, B = t - (Co >> 1), R = B + Co;
    return {R, G, B, x[3]};
}

// Calls visit for every place of a tile or block.
template <class Visit> void for_each_place(const Vector4& size, Visit visit) {
    Vector4 at{};
    for (at[3] = 0; at[3] < size[3]; ++at[3])
        for (at[2] = 0; at[2] < size[2]; ++at[2])
            for (at[1] = 0; at[1] < size[1]; ++at[1])
                for (at[0] = 0; at[0] < size[0]; ++at[0])
                    visit(at);
}

// --------------------------------------------------------------------------- part 4 for one block

void TileDecoder::reconstruct(const Block& block) {
    static const std::vector<Matrix> rotations = make_rotations();
    const size_t planes = static_cast<size_t>(header_.channels);
    const int N = product(block.size);
    const int F = header_.sample_type == 0 ? 14 : 8;
    const Scan& scan = scan_of(block.size);

    std::array<std::vector<int64_t>, 4> values;
    for (size_t p = 0; p < planes; ++p) { // 4.1
        values[p].assign(static_cast<size_t>(N), 0);
        const Step& step = block.rotation >= 0 && p < 3 ? code_.rotated_step : code_.step[p];
        const int longer = static_cast<int>(
            std::count_if(block.size.begin(), block.size.end(), [](int side) { return side > 1; }));
        std::array<Scale, 5> scale;
        const int V = size_[2] * size_[3];
        int k = 0;
        while (block.of_base && !(std::exp2(2 * k + 1) <= V * V && V * V < std::exp2(2 * k + 3)))
            ++k;
        for (int z = 0; z <= longer; ++z) {
            Scale& own = scale[static_cast<size_t>(z)];
            own = make_scale(step, N, z + k % 2, F, code_.dependent);
            own.x -= (k + 1) / 2;
        }
        for (size_t i = 0; i < block.levels[p].size(); ++i) {
            const int64_t level = block.levels[p][i];
            const int z = static_cast<int>(
                std::count_if(scan[i].k.begin(), scan[i].k.end(), [](int k) { return k > 0; }));
            const int offset = code_.offset[p == 0 ? 0 : 1][std::abs(level) == 1 ? 0 : 1];
            values[p][scan[i].where] = dequantise(level, scale[static_cast<size_t>(z)], offset);
        }
    }
    if (block.rotation >= 0) // 4.4
        for (size_t i = 0; i < static_cast<size_t>(N); ++i) {
            const auto rotated = rotate(rotations[static_cast<size_t>(block.rotation)],
                                        {values[0][i], values[1][i], values[2][i]});
            for (size_t p = 0; p < 3; ++p)
                values[p][i] = rotated[p];
        }
    for (size_t p = 0; p < planes; ++p) // 4.3
        inverse_transform(values[p], block.size, F - G());

    for_each_place(block.size, [&](const Vector4& at) {
        Vector4 in_tile{};
        for (size_t a = 0; a < 4; ++a)
            in_tile[a] = block.begin[a] + at[a];
        std::array<int64_t, 4> from_copy{};
        if (block.copies_base) // 4.6
            from_copy = predicted_from_base(block, in_tile);
        else if (block.copies())
            from_copy = predicted(block, at);
        for (size_t p = 0; p < planes; ++p) {
            int64_t x = values[p][place(at, block.size)] + from_copy[p];
            if (predicted_tile_)
                x = std::clamp(x, -value_limit(), value_limit() - 1);
            if (block.of_base)
                base_values_[p][place(in_tile, base_size_)] = x;
            else
                plane_values_[p][place(in_tile, size_)] = x;
        }
    });
}

// ------------------------------------------------------------------------------------ 4.7 the filter

void TileDecoder::filter() {
    static const std::array<std::array<Vector4, 4>, 3> rings = {{
        {{{1, 1, 0, 0}, {1, -1, 0, 0}, {-1, 1, 0, 0}, {-1, -1, 0, 0}}},
        {{{2, 2, 0, 0}, {2, -2, 0, 0}, {-2, 2, 0, 0}, {-2, -2, 0, 0}}},
        {{{0, 0, 1, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}, {0, 0, 0, -1}}},
    }};
    for (size_t p = 0; p < static_cast<size_t>(header_.channels); ++p) {
        std::vector<int64_t> before = plane_values_[p];
        for (int64_t& x : before)
            x = std::clamp(x, -value_limit(), value_limit() - 1);
        const Step step = code_.step[p];
        for_each_place(size_, [&](const Vector4& at) {
            const int64_t x = before[place(at, size_)];
            int64_t sum = 128;
            for (size_t i = 0; i < 3; ++i) {
                const auto [A, r] = (*code_.filter)[p == 0 ? 0 : 1][i];
                const int64_t width = r * (2048 + step.m);
                const int64_t B =
                    std::min<int64_t>(65535, (int64_t{std::abs(A)} << (28 - G() - step.e)) / width);
                for (const Vector4& offset : rings[i]) {
                    Vector4 to{};
                    for (size_t a = 0; a < 4; ++a)
                        to[a] = std::clamp(at[a] + offset[a], 0, size_[a] - 1);
                    const int64_t d = before[place(to, size_)] - x;
                    const int64_t D = header_.sample_type == 0 ? 4095 : 65535;
                    const int64_t lost = std::min(std::abs(d), D) * B / 4096;
                    const int64_t share = std::max<int64_t>(0, std::abs(A) - lost);
                    sum += (A < 0 ? -share : share) * d;
                }
            }
            plane_values_[p][place(at, size_)] = x + floor_div(sum, 256);
        });
    }
}

// 4.5
void TileDecoder::make_codes() {
    const size_t planes = static_cast<size_t>(header_.channels);
    std::array<int64_t, 4> background{};
    for (size_t c = 0; c < planes; ++c)
        background[c] = code_of(header_.background[c], header_.sample_type);
    background = to_planes(background, header_.colour);
    for_each_place(size_, [&](const Vector4& at) {
        std::array<int64_t, 4> x{};
        for (size_t p = 0; p < planes; ++p)
            x[p] = floor_div(plane_values_[p][place(at, size_)] + (1 << G()) / 2, 1 << G()) +
                   background[p];
        x = from_planes(x, header_.colour);
        for (size_t c = 0; c < planes; ++c)
            codes_[texel_number(at) * planes + c] = clamp_code(x[c], header_.sample_type);
    });
}

// ------------------------------------------------------------------------------- 3.6 corrections

void TileDecoder::add_corrections(const Payload& payload) {
    const size_t channels = static_cast<size_t>(header_.channels);
    const size_t texels = static_cast<size_t>(product(size_));
    const size_t S = static_cast<size_t>(size_[2]), T = static_cast<size_t>(size_[3]);
    for (size_t chunk = 0; chunk < payload.corrections.size(); ++chunk) {
        if (!payload.corrections[chunk])
            continue;
        Stream stream(*payload.corrections[chunk]);
        const size_t begin = chunk * 4096;
        const size_t count = std::min<size_t>(4096, texels - begin);
        std::vector<int> small(count * channels); // min(|multiplier|, 2)
        for (size_t i = 0; i < count; ++i)
            for (size_t c = 0; c < channels; ++c) {
                int n = 0;
                for (const size_t back : {size_t{1}, S, S * T})
                    if (back <= i)
                        n += small[(i - back) * channels + c];
                const int b = c == 0 ? 0 : small[i * channels + c - 1];
                const int token = stream.symbol(code_.correction[3 * n + b]);
                if (token == 0)
                    continue;
                int64_t multiplier = read_magnitude(stream, token - 1);
                small[i * channels + c] = static_cast<int>(std::min<int64_t>(multiplier, 2));
                if (stream.raw(1))
                    multiplier = -multiplier;
                int64_t& code = codes_[(begin + i) * channels + c];
                code = clamp_code(code + multiplier * (2 * code_.correction_error + 1),
                                  header_.sample_type);
            }
        require(stream.ends_well(), "corrections: the stream must end well");
    }
}

// ---------------------------------------------------------------------------- parts 3 and 4 for a tile

std::vector<uint16_t> TileDecoder::decode(Bytes bytes, const Vector4& size) {
    const size_t channels = static_cast<size_t>(header_.channels);
    const size_t texels = static_cast<size_t>(product(size));
    std::vector<uint16_t> samples(texels * channels);
    if (bytes.empty()) { // 1.4; a background of -0 becomes +0 like every decoded sample (4.5)
        for (size_t i = 0; i < samples.size(); ++i) {
            const uint16_t sample = header_.background[i % channels];
            samples[i] = sample_of(code_of(sample, header_.sample_type), header_.sample_type);
        }
        return samples;
    }
    if (header_.has_stored_tiles() && bytes.size() == texels * header_.texel_bytes()) { // 3.2
        for (size_t i = 0; i < samples.size(); ++i) {
            const int sample = header_.sample_type ? static_cast<int>(u16(bytes, 2 * i))
                                                   : static_cast<int>(u8(bytes, i));
            samples[i] =
                sample_of(clamp_code(code_of(static_cast<uint16_t>(sample), header_.sample_type),
                                     header_.sample_type),
                          header_.sample_type);
        }
        return samples;
    }
    size_ = size;
    blocks_.clear();
    nodes_ = 0;
    last_block_copied_ = has_base_ = last_copied_base_ = false;
    last_base_displacement_ = 0;
    displacement_ = {};
    codes_.assign(texels * channels, 0);
    const Payload payload = read_payload(bytes, header_, (texels + 4095) / 4096);
    for (size_t i = 0; i < payload.segments.size(); ++i) {
        Stream stream(payload.segments[i].bytes);
        if (i == 0) {
            read_base_tree(stream);
            read_split_tree(stream, {0, 0, 0, 0}, size, 0, 0);
        }
        const size_t begin = payload.segments[i].first_block;
        const size_t end =
            i + 1 < payload.segments.size() ? payload.segments[i + 1].first_block : blocks_.size();
        require(begin <= end && end <= blocks_.size(), "payload: first block");
        require(i == 0 || begin < blocks_.size(), "payload: first block");
        read_segment(stream, begin, end, i == 0 ? nodes_ : 0);
        require(stream.ends_well(), "segment: the stream must end well");
    }
    predicted_tile_ = std::any_of(blocks_.begin(), blocks_.end(),
                                  [](const Block& block) { return block.copies(); }) ||
                      has_base_;
    std::array<std::vector<const Block*>, 16> at_depth;
    for (Block& block : blocks_)
        at_depth[static_cast<size_t>(depth_of(block))].push_back(&block);
    for (size_t p = 0; p < channels; ++p) {
        plane_values_[p].assign(texels, 0);
        base_values_[p].assign(static_cast<size_t>(has_base_ ? product(base_size_) : 0), 0);
    }
    for (const auto& blocks : at_depth)
        for (const Block* block : blocks)
            reconstruct(*block);
    if (code_.filter)
        filter();
    make_codes();
    add_corrections(payload);
    for (size_t i = 0; i < samples.size(); ++i)
        samples[i] = sample_of(codes_[i], header_.sample_type);
    return samples;
}

// ------------------------------------------------------------------------- part 2, the whole texture

// The first texel of tile i of the n tiles along an axis of D texels.
int tile_begin(uint64_t i, uint64_t D, uint64_t n) {
    return static_cast<int>(i * D / n);
}

// The file's steps for the tiles of a level (1.4).
Code code_of_level(Code code, const Level& level) {
    const auto shift = [&level](Step& step) {
        step.e += level.step_shift;
        require(step.e <= 20, "LEVL: step_shift brings an exponent above 20");
    };
    for (Step& step : code.step)
        shift(step);
    shift(code.rotated_step);
    return code;
}

// All texels of a level, in the order of part 2.
std::vector<std::byte> decode_level(const Header& header, const Code& file_code, const Level& level,
                                    const std::vector<Bytes>& tiles) {
    const Code code = code_of_level(file_code, level);
    uint64_t texel_count = 1;
    for (const uint32_t extent : level.size)
        texel_count *= extent;
    require(texel_count <= 1ull << 31, "too large for this decoder"); // not a rule of the format
    std::vector<std::byte> texels(texel_count * header.texel_bytes());
    TileDecoder decoder(header, code);
    size_t number = level.first_tile;
    for (uint64_t it = 0; it < level.n[3]; ++it)
        for (uint64_t is = 0; is < level.n[2]; ++is)
            for (uint64_t iv = 0; iv < level.n[1]; ++iv)
                for (uint64_t iu = 0; iu < level.n[0]; ++iu) {
                    const uint64_t i[4] = {iu, iv, is, it};
                    Vector4 begin{}, size{};
                    for (size_t a = 0; a < 4; ++a) {
                        begin[a] = tile_begin(i[a], level.size[a], level.n[a]);
                        size[a] = tile_begin(i[a] + 1, level.size[a], level.n[a]) - begin[a];
                    }
                    const std::vector<uint16_t> samples = decoder.decode(tiles[number++], size);
                    size_t next = 0;
                    for (int v = 0; v < size[1]; ++v)
                        for (int u = 0; u < size[0]; ++u)
                            for (int t = 0; t < size[3]; ++t)
                                for (int s = 0; s < size[2]; ++s) {
                                    size_t at = static_cast<size_t>(begin[1] + v);
                                    at = at * level.size[0] + static_cast<size_t>(begin[0] + u);
                                    at = at * level.size[3] + static_cast<size_t>(begin[3] + t);
                                    at = at * level.size[2] + static_cast<size_t>(begin[2] + s);
                                    std::byte* out = &texels[at * header.texel_bytes()];
                                    for (int c = 0; c < header.channels; ++c) {
                                        const uint16_t sample = samples[next++];
                                        *out++ = static_cast<std::byte>(sample & 255);
                                        if (header.sample_type == 1)
                                            *out++ = static_cast<std::byte>(sample >> 8);
                                    }
                                }
                }
    return texels;
}

// How much further along u or v the views at x of n lie in the grid.
size_t shift(int alignment, uint32_t x, uint32_t n) {
    return alignment >= 0 ? static_cast<size_t>(alignment) * x
                          : static_cast<size_t>(-alignment) * (n - 1 - x);
}

// The texels of the texture, from those of its grid.
std::vector<std::byte> without_alignment(const Header& h, const std::vector<std::byte>& grid) {
    std::vector<std::byte> texels;
    const size_t bytes = h.texel_bytes();
    for (uint32_t v = 0; v < h.size[1]; ++v)
        for (uint32_t u = 0; u < h.size[0]; ++u)
            for (uint32_t t = 0; t < h.size[3]; ++t)
                for (uint32_t s = 0; s < h.size[2]; ++s) {
                    size_t at = v + shift(h.alignment[1], t, h.size[3]);
                    at = at * h.grid[0] + u + shift(h.alignment[0], s, h.size[2]);
                    at = (at * h.size[3] + t) * h.size[2] + s;
                    for (size_t k = 0; k < bytes; ++k)
                        texels.push_back(grid[at * bytes + k]);
                }
    return texels;
}

Decoded decode_file(Bytes file) {
    const Header header = read_header(file);
    const auto sections = read_section_table(file, header);
    Decoded result;
    if (sections.contains("meta"))
        result.metadata = read_metadata(sections.at("meta").bytes);
    const std::vector<Level> levels = read_levels(sections.at("LEVL").bytes, header);
    const Code code = read_code(sections.at("CODE").bytes);
    require(code.has_predictions == header.has_predictions(), "CODE: flag 1 and feature 4");
    const std::vector<Bytes> tiles = read_tiles(file, header, sections, levels);

    std::copy(header.size.begin(), header.size.end(), result.size);
    result.channels = header.channels;
    result.sample_type = header.sample_type;
    for (const Level& level : levels) {
        std::vector<std::byte> texels = decode_level(header, code, level, tiles);
        if (level.first_tile == 0)
            result.texels = without_alignment(header, texels);
        else
            result.coarse.push_back(std::move(texels));
    }
    return result;
}

} // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t crc) {
    static const auto table = [] {
        std::array<uint32_t, 256> result{};
        for (uint32_t i = 0; i < 256; ++i) {
            uint32_t value = i;
            for (int bit = 0; bit < 8; ++bit)
                value = value >> 1 ^ (value & 1 ? 0x82F63B78 : 0); // 0x1EDC6F41 reflected
            result[i] = value;
        }
        return result;
    }();
    crc = ~crc;
    for (std::byte b : bytes)
        crc = crc >> 8 ^ table[(crc ^ static_cast<uint32_t>(b)) & 255];
    return ~crc;
}

std::span<const std::uint8_t> default_parameters() {
    return default_parameter_list;
}

std::optional<Decoded> decode(std::span<const std::byte> file, std::string& error) {
    try {
        error.clear();
        return decode_file(file);
    } catch (const Refusal& refusal) {
        error = refusal.reason;
        return std::nullopt;
    }
}

} // namespace tessera_reference
