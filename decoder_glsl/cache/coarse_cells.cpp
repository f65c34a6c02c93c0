#include "decoder_glsl/cache/coarse_cells.h"

#include "decoder_glsl/shaders/shader_layout.h"
#include "format/samples.h"

#include <algorithm>
#include <array>
#include <vector>

namespace tessera {
namespace {

using namespace layout;

constexpr std::uint64_t most_bytes = 8u << 20; // of texels, and of words, in one box
constexpr std::size_t tile_words = tsr_coarse_words;

constexpr std::uint32_t parts_along(int axis) {
    return static_cast<std::uint32_t>(axis < axis_s ? tsr_coarse_uv : tsr_coarse_st);
}

// The texels of the level that overlap a part of a tile, along one axis.
struct Span {
    std::uint32_t first = 0;    // relative to the box that was read
    std::vector<float> weights; // texels of level 0 in the part that each of them covers
};

// Begin and end of part `part` of a tile of `extent` texels of level 0, as in coarse.comp.glsl.
std::pair<std::uint32_t, std::uint32_t> part_of(std::uint32_t part, std::uint32_t parts,
                                                std::uint32_t extent) {
    const std::uint32_t begin = (part * extent + parts - 1) / parts;
    const std::uint32_t end =
        std::min(std::max(((part + 1) * extent + parts - 1) / parts, begin + 1), extent);
    return {std::min(begin, end - 1), end};
}

class CellMaker {
public:
    CellMaker(const TileGrid& grid, const LevelEntry& level, TexelSource& source,
              const PutCoarse& put)
        : grid_(grid), level_(level), source_(source), put_(put), desc_(source.desc()),
          traits_(traits_of(desc_.type)) {}

    // Computes the coarse texels of a box of tiles, given by their coordinates in the grid.
    Status make(const Box4& tiles) {
        const Box4 texels = texels_of(tiles);
        if (std::max<std::uint64_t>(desc_.box_bytes(texels), tiles.texels() * tile_words * 4) >
            most_bytes)
            // Halves the slowest axis of more than one tile, which keeps the order of tiles.
            for (const int axis : {axis_t, axis_s, axis_v, axis_u}) {
                const auto a = static_cast<std::size_t>(axis);
                if (tiles.end[a] - tiles.begin[a] == 1)
                    continue;
                Box4 first = tiles, second = tiles;
                first.end[a] = second.begin[a] = (tiles.begin[a] + tiles.end[a]) / 2;
                TESSERA_TRY(make(first));
                return make(second);
            }
        return make_box(tiles, texels);
    }

private:
    // The texels of the level that cover the tiles.
    Box4 texels_of(const Box4& tiles) const {
        Extent4 last = tiles.end;
        for (std::uint32_t& coordinate : last)
            --coordinate;
        const Box4 first_box = grid_.box(tiles.begin), last_box = grid_.box(last);
        Box4 texels;
        for (int axis = 0; axis < 4; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            texels.begin[a] = first_box.begin[a] >> level_.lod(axis);
            texels.end[a] = ((last_box.end[a] - 1) >> level_.lod(axis)) + 1;
        }
        return texels;
    }

    // The spans of all parts of the tiles along an axis.
    std::vector<Span> spans_along(int axis, const Box4& tiles, const Box4& texels) const {
        const auto a = static_cast<std::size_t>(axis);
        const unsigned lod = level_.lod(axis);
        std::vector<Span> spans;
        Extent4 tile = tiles.begin;
        for (; tile[a] < tiles.end[a]; ++tile[a]) {
            const Box4 box = grid_.box(tile);
            for (std::uint32_t part = 0; part < parts_along(axis); ++part) {
                const auto [begin, end] =
                    part_of(part, parts_along(axis), box.end[a] - box.begin[a]);
                const std::uint32_t from = box.begin[a] + begin, to = box.begin[a] + end;
                Span span{(from >> lod) - texels.begin[a], {}};
                span.weights.resize(((to - 1) >> lod) - (from >> lod) + 1);
                for (std::uint32_t i = 0; i < span.weights.size(); ++i) {
                    const std::uint64_t x = std::uint64_t{(from >> lod) + i} << lod;
                    const std::uint64_t next = x + (std::uint64_t{1} << lod);
                    span.weights[i] = static_cast<float>(std::min<std::uint64_t>(next, to) -
                                                         std::max<std::uint64_t>(x, from));
                }
                spans.push_back(std::move(span));
            }
        }
        return spans;
    }

    Status make_box(const Box4& tiles, const Box4& texels) {
        bytes_.resize(static_cast<std::size_t>(desc_.box_bytes(texels)));
        TESSERA_TRY(source_.read(texels, bytes_));
        extent_ = texels.extent();
        for (int axis = 0; axis < 4; ++axis)
            spans_[static_cast<std::size_t>(axis)] = spans_along(axis, tiles, texels);
        std::vector<std::uint32_t> words; // of consecutive tiles
        std::uint64_t first = 0;
        Status status;
        const auto flush = [&] {
            if (status.ok() && !words.empty())
                status = put_(first, words);
            words.clear();
        };
        grid_.for_each(tiles, [&](std::uint64_t number) {
            if (number != first + words.size() / tile_words)
                flush();
            if (words.empty())
                first = number;
            const Extent4 tile = grid_.coordinates(number);
            Extent4 place{};
            for (std::size_t a = 0; a < 4; ++a)
                place[a] = (tile[a] - tiles.begin[a]) * parts_along(static_cast<int>(a));
            add_tile(place, words);
        });
        flush();
        return status;
    }

    // `place`: index of the tile's first span along each axis.
    void add_tile(const Extent4& place, std::vector<std::uint32_t>& words) const {
        for (std::uint32_t t = 0; t < tsr_coarse_st; ++t)
            for (std::uint32_t s = 0; s < tsr_coarse_st; ++s)
                for (std::uint32_t v = 0; v < tsr_coarse_uv; ++v)
                    for (std::uint32_t u = 0; u < tsr_coarse_uv; ++u)
                        pack(mean_of({&spans_[0][place[0] + u], &spans_[1][place[1] + v],
                                      &spans_[2][place[2] + s], &spans_[3][place[3] + t]}),
                             words);
    }

    float value_at(std::size_t sample) const {
        const std::uint16_t value = load_sample(bytes_.data() + sample * traits_.bytes, desc_.type);
        return traits_.is_float ? half_to_float(value) : static_cast<float>(value) / traits_.one;
    }

    std::array<float, 4> mean_of(const std::array<const Span*, 4>& spans) const {
        std::array<float, 4> sum{};
        float weights = 0;
        for (std::size_t v = 0; v < spans[1]->weights.size(); ++v)
            for (std::size_t u = 0; u < spans[0]->weights.size(); ++u)
                for (std::size_t t = 0; t < spans[3]->weights.size(); ++t) {
                    const std::size_t row =
                        (((spans[1]->first + v) * std::size_t{extent_[0]} + spans[0]->first + u) *
                             extent_[3] +
                         spans[3]->first + t) *
                            extent_[2] +
                        spans[2]->first;
                    const float row_weight =
                        spans[1]->weights[v] * spans[0]->weights[u] * spans[3]->weights[t];
                    for (std::size_t s = 0; s < spans[2]->weights.size(); ++s) {
                        const float weight = row_weight * spans[2]->weights[s];
                        weights += weight;
                        for (std::size_t c = 0; c < desc_.channels; ++c)
                            sum[c] += weight * value_at((row + s) * desc_.channels + c);
                    }
                }
        for (float& channel : sum)
            channel /= weights;
        return as_four(sum);
    }

    // Grey in all three colours, alpha 1 where there is none.
    std::array<float, 4> as_four(const std::array<float, 4>& c) const {
        switch (desc_.channels) {
        case 1:
            return {c[0], c[0], c[0], 1};
        case 2:
            return {c[0], c[0], c[0], c[1]};
        case 3:
            return {c[0], c[1], c[2], 1};
        default:
            return c;
        }
    }

    void pack(const std::array<float, 4>& value, std::vector<std::uint32_t>& words) const {
        std::uint32_t word[2] = {0, 0};
        for (std::size_t c = 0; c < 4; ++c)
            if (traits_.is_float)
                word[c / 2] |= std::uint32_t{float_to_half(value[c])} << (16 * (c % 2));
            else
                word[0] |= static_cast<std::uint32_t>(std::clamp(value[c], 0.0f, 1.0f) * 255 + 0.5f)
                           << (8 * c);
        words.insert(words.end(), {word[0], word[1]});
    }

    const TileGrid& grid_;
    const LevelEntry& level_;
    TexelSource& source_;
    const PutCoarse& put_;
    const TextureDesc desc_;
    const SampleTraits& traits_;
    std::vector<std::byte> bytes_; // texels of the box that was read
    Extent4 extent_{};             // of that box
    std::array<std::vector<Span>, 4> spans_;
};

} // namespace

Status make_coarse_cells(const TileGrid& grid, const LevelEntry& level, TexelSource& source,
                         const PutCoarse& put) {
    const bool fits = level.spatial_lod <= max_lod && level.angular_lod <= max_lod &&
                      level.size == coarse_level(grid.size(), level.spatial_lod, level.angular_lod,
                                                 level.step_shift)
                                        .size &&
                      source.desc().size == level.size;
    if (!fits)
        return {ErrorCode::bad_argument, "texels of " + to_string(source.desc().size) +
                                             " are not a coarse level of " +
                                             to_string(grid.size())};
    return CellMaker(grid, level, source, put).make({{0, 0, 0, 0}, grid.count()});
}

} // namespace tessera
