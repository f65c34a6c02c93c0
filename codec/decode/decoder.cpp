#include "codec/decoder.h"

#include "codec/decode/coarse_fill.h"
#include "codec/reconstruct/tile_decoder.h"
#include "codec/texels/slabs.h"
#include "format/container/tiles_ahead.h"
#include "format/levels.h"
#include "format/texture.h"
#include "format/work.h"

#include <algorithm>

namespace tessera {

struct Decoder::State {
    std::unique_ptr<ByteSource> source; // null if the caller owns it
    ContainerReader container;
    ColourCoding colour;
    std::vector<std::unique_ptr<TileCoding>> codings; // of the levels, finest first
    std::unique_ptr<CoarseFill> fill;
};

namespace {

struct Worker {
    TileDecoder decoder;
    std::vector<std::byte> texels, payload;
};

// As many workers as `threads` allows and `tiles` can use.
std::vector<Worker> make_workers(unsigned threads, std::size_t tiles, const TileCoding& coding,
                                 const ColourCoding& colour) {
    const std::size_t count = std::clamp<std::size_t>(tiles, 1, thread_count(threads));
    std::vector<Worker> workers;
    for (std::size_t i = 0; i < count; ++i)
        workers.push_back({.decoder = TileDecoder(coding, colour), .texels = {}, .payload = {}});
    return workers;
}

// The largest number of texels in a slab. Slabs of Locality::places that fit into a cache are
// gathered in a fifth less time, but a slab has at least the positions of one tile.
std::uint64_t slab_texels(const TileGrid& grid, Locality locality, std::uint64_t most) {
    if (locality != Locality::places)
        return most;
    constexpr std::uint64_t preferred = 2u << 20;
    const Extent4 tile = grid.box(0).extent(), size = grid.size(); // sides differ by a texel
    const std::uint64_t places = (tile[axis_u] + 1ull) * (tile[axis_v] + 1ull);
    return std::min(most, std::max(preferred, places * size[axis_s] * size[axis_t]));
}

} // namespace

Decoder::Decoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder::~Decoder() = default;

Result<Decoder> Decoder::open(ByteSource& source, const DecodeOptions& options) {
    TESSERA_TRY_ASSIGN(
        ContainerReader container,
        ContainerReader::open(source, {options.allow_partial, options.most_head_bytes}));
    TESSERA_TRY_ASSIGN(auto codings, level_codings(container).with_context(source.name()));
    const FileHeader& header = container.header();
    const ColourCoding colour{.desc = header.desc,
                              .transform = header.colour,
                              .background = header.background,
                              .corrections = (header.required_features & feature_corrections) != 0,
                              .stored = (header.required_features & feature_stored) != 0};
    std::unique_ptr<State> state(new State{.source = nullptr,
                                           .container = std::move(container),
                                           .colour = colour,
                                           .codings = std::move(codings),
                                           .fill = nullptr});
    state->fill =
        std::make_unique<CoarseFill>(state->container, state->colour, state->codings, options);
    return Decoder(std::move(state));
}

Result<Decoder> Decoder::open(std::unique_ptr<ByteSource> source, const DecodeOptions& options) {
    if (source == nullptr)
        return Status(ErrorCode::bad_argument, "the source of bytes is a null pointer");
    TESSERA_TRY_ASSIGN(Decoder decoder, open(*source, options));
    decoder.state_->source = std::move(source);
    return decoder;
}

Result<Decoder> Decoder::open_file(const std::string& path, const DecodeOptions& options) {
    TESSERA_TRY_ASSIGN(std::unique_ptr<ByteSource> source, tessera::open_file(path));
    return open(std::move(source), options);
}

const ContainerReader& Decoder::container() const {
    return state_->container;
}

const TextureDesc& Decoder::desc() const {
    return state_->container.desc();
}

namespace {

Status decode_payload(const ContainerReader& container, std::uint64_t tile, const Box4& box,
                      Integrity integrity, Worker& worker) {
    if (integrity == Integrity::tile) {
        TESSERA_TRY(container.read_tile(tile, worker.payload));
        return worker.decoder.decode(worker.payload, tile_shape(box), worker.texels);
    }
    TESSERA_TRY_ASSIGN(const TileBytes bytes, container.load_tile(tile));
    return worker.decoder.decode(bytes.bytes, tile_shape(box), worker.texels);
}

// Decodes one tile into worker.texels, or fills it if the options allow it.
Status decode_tile(const ContainerReader& container, CoarseFill& fill, std::uint64_t tile,
                   const Box4& box, Integrity integrity, Worker& worker) {
    worker.texels.resize(container.desc().box_bytes(box));
    const Status status = decode_payload(container, tile, box, integrity, worker);
    if (!status.ok() && fill.may_fill(tile, status)) {
        fill.note(tile);
        return fill.fill(box, worker.texels);
    }
    return status.with_context(container.name() + ": tile " + std::to_string(tile) + " (texels " +
                               to_string(box) + ")");
}

// Decodes one tile and writes its part of `slab`.
Status write_part(const ContainerReader& container, CoarseFill& fill, std::uint64_t tile,
                  const Box4& slab, TexelSink& sink, Worker& worker) {
    const Box4 tile_box = container.grid().box(tile), part = intersect(tile_box, slab);
    TESSERA_TRY(decode_tile(container, fill, tile, tile_box, Integrity::page, worker));
    if (part == tile_box)
        return sink.write(part, worker.texels);
    std::vector<std::byte> texels(container.desc().box_bytes(part));
    copy_box(part, tile_box, worker.texels, part, texels, container.desc().texel_bytes());
    return sink.write(part, texels);
}

// Decodes one tile and copies its part of `box`. Aligned views may leave most of the grid empty. An
// empty tile takes no bytes, so one texel is decoded for all of it; otherwise empty tiles could
// take longer than the requested texels.
Status decode_part(const ContainerReader& container, CoarseFill& fill, std::uint64_t tile,
                   const AlignedViews& views, const Box4& box, std::span<std::byte> out,
                   Integrity integrity, Worker& worker) {
    const Box4 tile_box = container.grid().box(tile);
    const Box4 decoded =
        views.any() && container.is_empty(tile) ? Box4::of_texel(tile_box.begin) : tile_box;
    TESSERA_TRY(decode_tile(container, fill, tile, decoded, integrity, worker));
    views.copy_from_grid(tile_box, worker.texels, box, out, container.desc().texel_bytes());
    return {};
}

Status check_inside(const ContainerReader& container, const Box4& box, const Extent4& size) {
    return is_inside(box, size)
               ? Status()
               : Status(ErrorCode::bad_argument, container.name() + ": box " + to_string(box) +
                                                     " does not lie inside " + to_string(size));
}

// Checks a request for `box` of a level of this size, into a buffer of this many bytes.
Status check_request(const ContainerReader& container, const Box4& box, const Extent4& size,
                     std::size_t bytes) {
    TESSERA_TRY(check_inside(container, box, size));
    if (const std::uint64_t needed = container.desc().box_bytes(box); bytes != needed)
        return {ErrorCode::bad_argument, "the buffer has " + std::to_string(bytes) +
                                             " bytes, but the box needs " + std::to_string(needed)};
    return {};
}

} // namespace

Status Decoder::decode_box(const Box4& box, std::span<std::byte> out,
                           const ReadOptions& options) const {
    return decode_views(state_->container.aligned_views(), box, out, options);
}

Status Decoder::decode_grid_box(const Box4& box, std::span<std::byte> out,
                                const ReadOptions& options) const {
    return decode_views({state_->container.grid().size(), {}}, box, out, options);
}

Status Decoder::decode_views(const AlignedViews& views, const Box4& box, std::span<std::byte> out,
                             const ReadOptions& options) const {
    const ContainerReader& container = state_->container;
    TESSERA_TRY(check_request(container, box, views.texture_size(), out.size()));
    const TileGrid& grid = container.grid();
    const std::vector<std::uint64_t> tiles = views.tiles_touched(grid, box);
    std::vector<Worker> workers =
        make_workers(options.threads, tiles.size(), *state_->codings[0], state_->colour);
    const auto decode_one = [&](Worker& worker, std::uint64_t tile) -> Status {
        if (options.cancelled && options.cancelled())
            return {ErrorCode::runtime, "interrupted"};
        return decode_part(container, *state_->fill, tile, views, box, out, options.integrity,
                           worker);
    };
    const auto tell = [&](std::size_t done) {
        if (options.progress)
            options.progress("decode", static_cast<double>(done),
                             static_cast<double>(tiles.size()));
    };
    // Integrity::tile does not read pages, so fetching pages ahead would be useless.
    const bool by_pages = options.integrity == Integrity::page;
    TilesAhead ahead(container, by_pages ? tiles : std::vector<std::uint64_t>());
    for (std::size_t done = 0; done < tiles.size();) {
        std::size_t window = tiles.size();
        if (by_pages) {
            TESSERA_TRY_ASSIGN(window, ahead.ready(done));
        }
        TESSERA_TRY(parallel_for(
            workers, window,
            [&](Worker& worker, std::size_t i) { return decode_one(worker, tiles[done + i]); },
            [&](std::size_t i) { tell(done + i); }));
        done += window;
    }
    tell(tiles.size());
    return {};
}

Status Decoder::decode(const Box4& box, TexelSink& sink, unsigned threads,
                       const ProgressFunction& progress, std::uint64_t slab_bytes) const {
    const ContainerReader& container = state_->container;
    TESSERA_TRY(check_inside(container, box, desc().size));
    const TileGrid& grid = container.grid();
    const AlignedViews views = container.aligned_views();
    // With aligned views, each tile holds parts of many rows. Slabs are therefore as large as
    // possible and gathered here before they are written.
    const bool gathers = views.any();
    const Locality locality =
        gathers && sink.locality() == Locality::any ? Locality::places : sink.locality();
    std::uint64_t most_texels = slab_bytes / desc().texel_bytes();
    most_texels = gathers ? most_texels / 2 : slab_texels(grid, locality, most_texels);
    TESSERA_TRY_ASSIGN(auto slabs, make_slabs(gathers ? TileGrid(desc().size, desc().size) : grid,
                                              box, locality, {most_texels, false})
                                       .with_context(container.name()));
    std::vector<std::uint64_t> order;
    std::size_t most_tiles = 0;
    for (Slab& slab : slabs) {
        if (gathers)
            slab.tiles = container.tiles_touched(slab.box);
        most_tiles = std::max(most_tiles, slab.tiles.size());
        order.insert(order.end(), slab.tiles.begin(), slab.tiles.end());
    }
    std::vector<Worker> workers =
        make_workers(threads, most_tiles, *state_->codings[0], state_->colour);
    std::vector<std::byte> gathered;
    const std::size_t total = order.size();
    TilesAhead ahead(container, std::move(order));
    std::size_t done = 0;
    for (const Slab& slab : slabs) {
        TESSERA_TRY(sink.begin_slab(slab.box));
        if (gathers)
            gathered.resize(static_cast<std::size_t>(desc().box_bytes(slab.box)));
        for (std::span<const std::uint64_t> left = slab.tiles; !left.empty();) {
            TESSERA_TRY_ASSIGN(const std::size_t window, ahead.ready(done));
            const auto tiles = left.first(std::min(window, left.size()));
            TESSERA_TRY(parallel_for(
                workers, tiles.size(),
                [&](Worker& worker, std::size_t i) -> Status {
                    if (gathers)
                        return decode_part(container, *state_->fill, tiles[i], views, slab.box,
                                           gathered, Integrity::page, worker);
                    return write_part(container, *state_->fill, tiles[i], slab.box, sink, worker);
                },
                [&](std::size_t i) {
                    if (progress)
                        progress("decode", static_cast<double>(done + i),
                                 static_cast<double>(total));
                }));
            done += tiles.size();
            left = left.subspan(tiles.size());
        }
        if (gathers)
            TESSERA_TRY(sink.write(slab.box, gathered));
        TESSERA_TRY(sink.end_slab());
    }
    return sink.finish();
}

Status Decoder::decode_coarse_box(std::size_t level, const Box4& box,
                                  std::span<std::byte> out) const {
    const ContainerReader& container = state_->container;
    if (level == 0 || level >= container.levels().size())
        return {ErrorCode::bad_argument,
                container.name() + ": there is no coarse level " + std::to_string(level)};
    TESSERA_TRY(check_request(container, box, container.levels()[level].size, out.size())
                    .with_context("coarse level " + std::to_string(level)));
    return state_->fill->texels_of(level, box, out);
}

Status Decoder::check_tile(std::uint64_t tile) const {
    return state_->fill->check(tile);
}

FillReport Decoder::fill_report() const {
    return state_->fill->report();
}

} // namespace tessera
