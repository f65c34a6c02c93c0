#include "codec/pass/sample_pass.h"

#include "codec/pass/tile_crew.h"
#include "format/work.h"

#include <memory>
#include <utility>

namespace tessera {
namespace {

// Calls work(worker, i), which returns a Status, for every tile of a sample.
template <class Work> Status for_each_tile(TileCrew& crew, const Sample& sample, const Work& work) {
    return parallel_for(
        crew.workers, sample.boxes.size(),
        [&](TileWorker& worker, std::size_t i) -> Status {
            TESSERA_TRY(check_cancelled(crew.plan));
            return work(worker, i);
        },
        [](std::size_t) {});
}

// The levels of a base picture's blocks only.
TileLevels tree_of(const TileLevels& levels, std::size_t planes) {
    TileLevels tree = levels;
    const std::size_t kept = levels.base_blocks * planes;
    if (kept < levels.planes.size())
        tree.nonzeros.resize(levels.planes[kept].first);
    tree.planes.resize(kept);
    tree.nonzeros.shrink_to_fit();
    return tree;
}

} // namespace

Result<PassResult> run_pass(const EncodePlan& plan, const CodingParameters& parameters,
                            const Sample& sample, FilterStatistics* filter) {
    const auto on_heap = std::make_unique<TileCrew>(plan, parameters, true);
    TileCrew& crew = *on_heap;
    std::vector<CodedTile> tiles(sample.boxes.size());
    // Summed in the order of the tiles, so that the threads do not affect the sum.
    std::vector<FilterStatistics> statistics(filter != nullptr ? tiles.size() : 0);
    std::vector<TileLevels> trees(tiles.size());
    TESSERA_TRY(for_each_tile(crew, sample, [&](TileWorker& worker, std::size_t i) -> Status {
        TESSERA_TRY(crew.encode(worker, sample.boxes[i], sample.tiles[i], tiles[i],
                                filter != nullptr ? &statistics[i] : nullptr));
        trees[i] = tree_of(worker.levels, static_cast<std::size_t>(crew.coding.planes));
        return {};
    }));
    for (const FilterStatistics& one : statistics)
        filter->add(one);
    PassResult pass = crew.finish(0, std::move(tiles), nullptr);
    pass.trees = std::move(trees);
    return pass;
}

Result<PassResult> run_pass_as(const EncodePlan& plan, const CodingParameters& parameters,
                               const Sample& sample, std::span<const TileLevels> trees) {
    const auto on_heap = std::make_unique<TileCrew>(plan, parameters, true);
    TileCrew& crew = *on_heap;
    std::vector<CodedTile> tiles(sample.boxes.size());
    TESSERA_TRY(for_each_tile(crew, sample, [&](TileWorker& worker, std::size_t i) {
        return crew.encode_as(worker, sample.boxes[i], sample.tiles[i], trees[i], tiles[i]);
    }));
    return crew.finish(0, std::move(tiles), nullptr);
}

Result<Statistics> count_symbols(const EncodePlan& plan, const CodingParameters& parameters,
                                 const Sample& sample, std::span<const TileLevels> trees) {
    const auto on_heap = std::make_unique<TileCrew>(plan, parameters, true);
    TileCrew& crew = *on_heap;
    TESSERA_TRY(for_each_tile(crew, sample, [&](TileWorker& worker, std::size_t i) -> Status {
        if (trees.empty())
            worker.encoder.encode(sample.tiles[i], tile_shape(sample.boxes[i]), worker.levels);
        else
            worker.encoder.encode_as(sample.tiles[i], trees[i], worker.levels);
        count_symbols(worker.levels, crew.coding, worker.statistics);
        return {};
    }));
    Statistics all;
    for (const TileWorker& worker : crew.workers)
        all.add(worker.statistics);
    return all;
}

Result<std::vector<float>>
estimated_costs(const EncodePlan& plan, const CodingParameters& parameters, const Sample& sample) {
    const auto on_heap = std::make_unique<TileCrew>(plan, parameters, true);
    TileCrew& crew = *on_heap;
    std::vector<float> costs(sample.boxes.size());
    TESSERA_TRY(for_each_tile(crew, sample, [&](TileWorker& worker, std::size_t i) -> Status {
        costs[i] =
            worker.encoder.estimate(sample.tiles[i], tile_shape(sample.boxes[i]), worker.levels);
        return {};
    }));
    return costs;
}

} // namespace tessera
