#include "codec/decoder.h"

#include "codec/copy_box.h"
#include "codec/parallel.h"
#include "codec/slabs.h"
#include "codec/tile_decoder.h"
#include "format/tiles_ahead.h"

#include <algorithm>

namespace tessera {

struct Decoder::State {
    ContainerReader container;
    ColourCoding colour;
    std::unique_ptr<TileCoding> coding;
};

namespace {

struct Worker {
    TileDecoder decoder;
    std::vector<std::byte> texels, payload;
};

std::vector<Worker> make_workers(unsigned threads, const TileCoding& coding,
                                 const ColourCoding& colour) {
    std::vector<Worker> workers;
    for (unsigned i = 0; i < thread_count(threads); ++i)
        workers.push_back({TileDecoder(coding, colour), {}, {}});
    return workers;
}

} // namespace

Decoder::Decoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder::~Decoder() = default;

Result<Decoder> Decoder::open(ByteSource& source) {
    Result<ContainerReader> container = ContainerReader::open(source);
    if (!container)
        return container.status();
    const Result<CodingParameters> parameters =
        read_coding_parameters(container->codec_parameters());
    if (!parameters)
        return parameters.status().with_context(source.name());
    const FileHeader& header = container->header();
    if (const Status agree = check_features(*parameters, header.required_features); !agree.ok())
        return agree.with_context(source.name());
    const ColourCoding colour{header.desc, header.colour, header.background,
                              (header.required_features & feature_corrections) != 0};
    auto coding = std::make_unique<TileCoding>(*parameters, header.desc.type, header.desc.channels);
    return Decoder(
        std::unique_ptr<State>(new State{std::move(*container), colour, std::move(coding)}));
}

const ContainerReader& Decoder::container() const {
    return state_->container;
}

const TextureDesc& Decoder::desc() const {
    return state_->container.desc();
}

namespace {

// Decodes one tile into worker.texels.
Status decode_tile(const ContainerReader& container, std::uint64_t tile, const Box4& box,
                   Integrity integrity, Worker& worker) {
    worker.texels.resize(container.desc().box_bytes(box));
    Status status;
    if (integrity == Integrity::tile) {
        TESSERA_TRY(container.read_tile(tile, worker.payload));
        status = worker.decoder.decode(worker.payload, tile_shape(box), worker.texels);
    } else {
        const Result<TileBytes> bytes = container.load_tile(tile);
        if (!bytes)
            return bytes.status();
        status = worker.decoder.decode(bytes->bytes, tile_shape(box), worker.texels);
    }
    return status.with_context(container.name() + ": tile " + std::to_string(tile) + " (texels " +
                               to_string(box) + ")");
}

} // namespace

Status Decoder::decode_box(const Box4& box, std::span<std::byte> out, unsigned threads,
                           Integrity integrity) const {
    const ContainerReader& container = state_->container;
    if (!is_inside(box, desc().size))
        return {ErrorCode::bad_argument, container.name() + ": box " + to_string(box) +
                                             " does not lie inside " + to_string(desc().size)};
    if (out.size() != desc().box_bytes(box))
        return {ErrorCode::bad_argument, "the buffer does not have the size of the box"};
    const TileGrid& grid = container.grid();
    std::vector<std::uint64_t> tiles;
    grid.for_each(grid.touched(box), [&tiles](std::uint64_t tile) { tiles.push_back(tile); });
    std::vector<Worker> workers = make_workers(threads, *state_->coding, state_->colour);
    const auto decode_one = [&](Worker& worker, std::uint64_t tile) -> Status {
        const Box4 tile_box = grid.box(tile);
        TESSERA_TRY(decode_tile(container, tile, tile_box, integrity, worker));
        copy_box(intersect(tile_box, box), tile_box, worker.texels, box, out, desc().texel_bytes());
        return {};
    };
    const auto no_progress = [](std::size_t) {};
    if (integrity == Integrity::tile) // reads past the pages, so none are brought
        return parallel_for(
            workers, tiles.size(),
            [&](Worker& worker, std::size_t i) { return decode_one(worker, tiles[i]); },
            no_progress);
    TilesAhead ahead(container, tiles);
    for (std::size_t done = 0; done < tiles.size();) {
        const Result<std::size_t> window = ahead.ready(done);
        TESSERA_TRY(window.status());
        TESSERA_TRY(parallel_for(
            workers, *window,
            [&](Worker& worker, std::size_t i) { return decode_one(worker, tiles[done + i]); },
            no_progress));
        done += *window;
    }
    return {};
}

Status Decoder::decode(const Box4& box, TexelSink& sink, unsigned threads,
                       const ProgressFunction& progress) const {
    const ContainerReader& container = state_->container;
    if (!is_inside(box, desc().size))
        return {ErrorCode::bad_argument, container.name() + ": box " + to_string(box) +
                                             " does not lie inside " + to_string(desc().size)};
    const TileGrid& grid = container.grid();
    std::vector<Worker> workers = make_workers(threads, *state_->coding, state_->colour);
    const std::vector<Slab> slabs = make_slabs(grid, box, sink.locality());
    std::vector<std::uint64_t> order;
    for (const Slab& slab : slabs)
        order.insert(order.end(), slab.tiles.begin(), slab.tiles.end());
    const std::size_t total = order.size();
    TilesAhead ahead(container, std::move(order));
    std::size_t done = 0;
    for (const Slab& slab : slabs) {
        TESSERA_TRY(sink.begin_slab(slab.box));
        for (std::span<const std::uint64_t> left = slab.tiles; !left.empty();) {
            const Result<std::size_t> window = ahead.ready(done);
            TESSERA_TRY(window.status());
            const auto tiles = left.first(std::min(*window, left.size()));
            TESSERA_TRY(parallel_for(
                workers, tiles.size(),
                [&](Worker& worker, std::size_t i) -> Status {
                    const Box4 tile_box = grid.box(tiles[i]);
                    TESSERA_TRY(
                        decode_tile(container, tiles[i], tile_box, Integrity::page, worker));
                    const Box4 part = intersect(tile_box, box);
                    if (part == tile_box)
                        return sink.write(part, worker.texels);
                    std::vector<std::byte> texels(desc().box_bytes(part));
                    copy_box(part, tile_box, worker.texels, part, texels, desc().texel_bytes());
                    return sink.write(part, texels);
                },
                [&](std::size_t i) {
                    if (progress)
                        progress("decode", static_cast<double>(done + i),
                                 static_cast<double>(total));
                }));
            done += tiles.size();
            left = left.subspan(tiles.size());
        }
        TESSERA_TRY(sink.end_slab());
    }
    return sink.finish();
}

} // namespace tessera
