#include "tests/reference/spec_index.h"

#include "tests/reference/spec_decoder.h"

#include <algorithm>
#include <utility>

namespace tessera_reference::spec {

std::vector<Level> read_levels(const std::map<std::string, Section>& sections,
                               const Header& header) {
    const Bytes section = header.level_count > 1 ? sections.at("LEVL").bytes : Bytes();
    require(section.size() == 4 * (header.level_count - 1), "LEVL: length");
    std::vector<Level> levels;
    int spatial = 0, angular = 0;
    uint64_t tiles = 0;
    for (size_t i = 0; i < header.level_count; ++i) {
        Level level;
        if (i > 0) {
            const Bytes entry = section.subspan(4 * (i - 1), 4);
            const int spatial_lod = u8(entry, 0), angular_lod = u8(entry, 1);
            require(u8(entry, 2) == 0, "LEVL: quality_layer");
            level.step_shift = u8(entry, 3);
            require(spatial_lod >= spatial && angular_lod >= angular &&
                        (spatial_lod > spatial || angular_lod > angular) && spatial_lod <= 20 &&
                        angular_lod <= 20 && level.step_shift <= 15,
                    "LEVL: lods and step_shift");
            spatial = spatial_lod;
            angular = angular_lod;
        }
        for (size_t a = 0; a < 4; ++a) {
            const uint64_t joined = 1ull << (a < 2 ? spatial : angular);
            level.size[a] = static_cast<uint32_t>((header.grid[a] + joined - 1) / joined);
            level.n[a] = (level.size[a] + header.tile_extent[a] - 1) / header.tile_extent[a];
            level.tiles *= level.n[a]; // at most 2^48, like the number of texels
        }
        level.first_tile = tiles;
        tiles += level.tiles;
        require(tiles <= 0xFFFFFFFF, "too many tiles");
        levels.push_back(level);
    }
    return levels;
}

namespace {

// The first tile and the number of tiles of each group, in the order of the groups.
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
    uint64_t bits(int count) { // reads the lowest bit of a byte first
        uint64_t value = 0;
        for (int i = 0; i < count; ++i) {
            require(at_ / 8 < bytes_.size(), "index record: cut short");
            value |= static_cast<uint64_t>(u8(bytes_, at_ / 8) >> at_ % 8 & 1) << i;
            ++at_;
        }
        return value;
    }
    size_t finish() { // checks that zero bits pad the last byte; returns the bytes read
        while (at_ % 8 != 0)
            require(bits(1) == 0, "index record: padding");
        return at_ / 8;
    }

private:
    Bytes bytes_;
    size_t at_ = 0;
};

// Reads the lengths of n tiles from an index record. `used` becomes its size without checksums.
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

// The sizes of the pages that hold a group's tiles.
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

} // namespace

std::vector<Bytes> read_tiles(Bytes file, const Header& header,
                              const std::map<std::string, Section>& sections,
                              const std::vector<Level>& levels) {
    const Section& index = sections.at("INDX");
    const Section& data = sections.at("DATA");
    const auto group_tiles = make_groups(levels);
    const uint64_t groups = group_tiles.size();
    uint64_t longest = 16 * header.channels;
    for (const uint32_t extent : header.tile_extent)
        longest *= extent;
    longest += 1u << 18;
    require(sections.contains("ROOT") == (groups > 1), "ROOT: present with several groups");
    const Bytes root = groups > 1 ? sections.at("ROOT").bytes : Bytes();
    require(root.size() == 12 * (groups - 1), "ROOT: length");
    // Where the bytes and the record of group g start.
    const auto data_start = [&](uint64_t g) {
        return g == 0 ? 0 : g == groups ? data.bytes.size() : u64(root, 12 * (g - 1));
    };
    const auto record_start = [&](uint64_t g) {
        return g == 0 ? 0 : g == groups ? index.bytes.size() : u32(root, 12 * (g - 1) + 8);
    };

    std::vector<Bytes> tiles(levels.back().first_tile + levels.back().tiles);
    for (uint64_t g = 0; g < groups; ++g) {
        require(data_start(g) <= data_start(g + 1) && data_start(g + 1) <= data.bytes.size(),
                "ROOT: data offsets");
        const uint64_t begin = data.offset + data_start(g), end = data.offset + data_start(g + 1);
        const uint64_t record_begin = record_start(g), record_end = record_start(g + 1);
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

} // namespace tessera_reference::spec
