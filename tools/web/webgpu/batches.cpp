// The functions that webgpu.js calls besides those of tools/web/decoder/exports.cpp: they prepare the
// tiles of a box for the shaders of decoder_glsl. A box is in the grid of level 0's tiles.
#include "decoder_glsl/batch/decode_batch.h"
#include "tools/web/decoder/open_file.h"

#include <algorithm>
#include <map>

namespace tessera {
namespace {

// Of one batch. The work of a tile is bounded by the format, so a single tile may exceed them.
constexpr BatchLimits batch_limits{.tiles = 1024,
                                   .work_words = (std::uint64_t{32} << 20) / 4,
                                   .coefficients = (std::uint64_t{32} << 20) / 16,
                                   .words = (std::uint64_t{32} << 20) / 4};

// The box whose tiles are prepared.
struct BoxInWork {
    Box4 hull; // of all of its tiles
    std::vector<std::uint64_t> tiles;
    std::size_t next = 0;
    std::optional<BatchBuilder> builder;
};

std::map<std::uint32_t, DecodeTables> tables_of_layers;
BoxInWork box_in_work;
DecodeBatch last_batch;
std::vector<double> batch_numbers;

Result<DecodeTables*> tables_of_layer() {
    const auto found = tables_of_layers.find(file.selected);
    if (found != tables_of_layers.end())
        return &found->second;
    TESSERA_TRY_ASSIGN(DecodeTables made, DecodeTables::make(container()));
    return &tables_of_layers.emplace(file.selected, std::move(made)).first->second;
}

Status begin_box(const std::uint32_t* corners) {
    TESSERA_TRY_ASSIGN(const Box4 wanted, checked_box(of_grid, corners));
    TESSERA_TRY_ASSIGN(DecodeTables * made, tables_of_layer());
    const TileGrid& grid = container().grid();
    box_in_work.hull = wanted;
    box_in_work.tiles = grid.tiles_touched(wanted);
    box_in_work.next = 0;
    for (const std::uint64_t tile : box_in_work.tiles) {
        const Box4 of_tile = grid.box(tile);
        for (std::size_t axis = 0; axis < 4; ++axis) {
            box_in_work.hull.begin[axis] =
                std::min(box_in_work.hull.begin[axis], of_tile.begin[axis]);
            box_in_work.hull.end[axis] = std::max(box_in_work.hull.end[axis], of_tile.end[axis]);
        }
    }
    const Extent4 extent = box_in_work.hull.extent();
    box_in_work.builder.emplace(*made, grid, batch_limits,
                                TexelPlan{.stride_s = extent[axis_s], .stride_t = extent[axis_t]});
    return {};
}

// The pixel of the tile's first texel, where angular images lie side by side.
TexelPlace place_of(std::uint64_t tile) {
    const Extent4 first = container().grid().box(tile).begin, extent = box_in_work.hull.extent();
    const auto pixel = [&](std::size_t place, std::size_t direction) {
        return (first[place] - box_in_work.hull.begin[place]) * extent[direction] +
               first[direction] - box_in_work.hull.begin[direction];
    };
    return {.x = pixel(axis_u, axis_s), .y = pixel(axis_v, axis_t)};
}

// Fills a batch with the next tiles. May be called again when bytes are missing.
Status prepare_batch() {
    for (; box_in_work.next < box_in_work.tiles.size(); ++box_in_work.next) {
        const std::uint64_t tile = box_in_work.tiles[box_in_work.next];
        TESSERA_TRY_ASSIGN(const TileBytes loaded, container().load_tile(tile));
        if (!box_in_work.builder->add(tile, loaded.bytes, place_of(tile)))
            break;
    }
    last_batch = box_in_work.builder->empty() ? DecodeBatch{} : box_in_work.builder->finish();
    return {};
}

double address_of(const std::uint32_t* words) {
    return static_cast<double>(reinterpret_cast<std::uintptr_t>(words));
}

} // namespace

// Begins a box, whose bytes web_fetch() has brought. level: of_grid; corners: as for web_box().
WEB_EXPORT(int, web_batches)(std::uint32_t, const std::uint32_t* corners) {
    return answer([&] { return begin_box(corners); });
}

// Prepares the next batch of the box.
WEB_EXPORT(int, web_next_batch)() {
    return answer([&] { return prepare_batch(); });
}

// The numbers that JavaScript names batchFields: of the last batch, without tiles behind the last one
// of a box; then the begins and ends of the box of all tiles. Words are addresses and counts.
WEB_EXPORT(const double*, web_batch)() {
    const DecodeTables& made = tables_of_layers.at(file.selected);
    const auto words = made.words();
    batch_numbers = {static_cast<double>(last_batch.tiles.size()),
                     static_cast<double>(last_batch.damaged.size()),
                     static_cast<double>(last_batch.most_segments),
                     static_cast<double>(last_batch.raw_chunks),
                     static_cast<double>(last_batch.corrections),
                     static_cast<double>(last_batch.waves),
                     static_cast<double>(last_batch.most_texels),
                     last_batch.predicted ? 1.0 : 0.0,
                     last_batch.borders ? 1.0 : 0.0,
                     static_cast<double>(last_batch.work_words),
                     static_cast<double>(last_batch.coefficients),
                     address_of(last_batch.words.data()),
                     static_cast<double>(last_batch.words.size()),
                     address_of(words.data()),
                     static_cast<double>(words.size()),
                     static_cast<double>(made.most_words()),
                     static_cast<double>(made.generation()),
                     made.filters() ? 1.0 : 0.0};
    for (const Extent4& corner : {box_in_work.hull.begin, box_in_work.hull.end})
        batch_numbers.insert(batch_numbers.end(), corner.begin(), corner.end());
    return batch_numbers.data();
}

} // namespace tessera
