// Decodes the whole texture (FORMAT.md part 2).
#include "tests/reference/spec_decoder.h"

#include "tests/reference/spec_index.h"
#include "tests/reference/spec_tile.h"

#include <algorithm>
#include <array>

namespace tessera_reference {
namespace spec {
namespace {

// The first texel of tile i if n tiles divide an axis of D texels.
int tile_begin(uint64_t i, uint64_t D, uint64_t n) {
    return static_cast<int>(i * D / n);
}

// The coding parameters with the steps of a level (1.5).
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

// Decodes all texels of a level, in the order of part 2.
std::vector<std::byte> decode_level(const Header& header, const Code& file_code, const Level& level,
                                    const std::vector<Bytes>& tiles) {
    const Code code = code_of_level(file_code, level);
    uint64_t texel_count = 1;
    for (const uint32_t extent : level.size)
        texel_count *= extent;
    require(texel_count <= 1ull << 31, "too large for this decoder"); // not a limit of the format
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

// The offset along u or v, in texels of the grid, of the views at position x of n.
size_t shift(int alignment, uint32_t x, uint32_t n) {
    return alignment >= 0 ? static_cast<size_t>(alignment) * x
                          : static_cast<size_t>(-alignment) * (n - 1 - x);
}

// Copies the texels of the texture from those of its grid.
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
    const auto sections = read_sections(file, header);
    Decoded result;
    if (sections.contains("meta"))
        result.metadata = read_metadata(sections.at("meta").bytes);
    check_geometry(sections, header);
    const std::vector<Level> levels = read_levels(sections, header);
    const Code code = read_code(sections.at("CODE").bytes, header);
    require(code.has_predictions == header.has_predictions(), "CODE: flag 1 and feature 4");
    require(code.leaves_out_transforms == header.leaves_out_transforms(),
            "CODE: flag 10 and feature 8");
    require(code.transforms_any_plane == header.transforms_any_plane(),
            "CODE: flag 11 and feature 9");
    require(code.has_plane_trees == header.has_plane_trees(), "CODE: flag 12 and feature 10");
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
} // namespace spec

std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t crc) {
    static const auto table = [] {
        std::array<std::uint32_t, 256> result{};
        for (std::uint32_t i = 0; i < 256; ++i) {
            std::uint32_t value = i;
            for (int bit = 0; bit < 8; ++bit)
                value = value >> 1 ^ (value & 1 ? 0x82F63B78 : 0); // 0x1EDC6F41, bits reversed
            result[i] = value;
        }
        return result;
    }();
    crc = ~crc;
    for (std::byte b : bytes)
        crc = crc >> 8 ^ table[(crc ^ static_cast<std::uint32_t>(b)) & 255];
    return ~crc;
}

std::optional<Decoded> decode(std::span<const std::byte> file, std::string& error) {
    try {
        error.clear();
        return spec::decode_file(file);
    } catch (const spec::Refusal& refusal) {
        error = refusal.reason;
        return std::nullopt;
    }
}

} // namespace tessera_reference
