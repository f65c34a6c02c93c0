#include "codec/tile_encoder/tree_encoder.h"

#include "codec/tile_encoder/base_picture.h"
#include "codec/tile_encoder/picture_encoder.h"

#include <algorithm>
#include <utility>

namespace tessera {
namespace {

// Typical bits of a block beside its levels, as its coding does not see them.
constexpr float usual_prediction_bits = 6.0f;
constexpr float usual_split_bits = 1.3f; // its share of the split tree
constexpr float more_blocks_bits = 1.0f; // more for each of four quarters
constexpr int smallest_to_split = 8;     // side of a block; the search goes down to 4

// Appends the levels of a block, whose planes in `from` begin at `first_plane`, to the tile `out`.
void put_levels(const TileLevels& from, std::size_t first_plane, std::size_t planes,
                std::size_t block, TileLevels& out) {
    for (std::size_t p = 0; p < planes; ++p) {
        PlaneLevels plane = from.planes[first_plane + p];
        const auto levels = from.levels(plane);
        plane.first = static_cast<std::uint32_t>(out.nonzeros.size());
        out.planes[block * planes + p] = plane;
        out.nonzeros.insert(out.nonzeros.end(), levels.begin(), levels.end());
    }
}

// Puts levels into the order of the blocks, in which a decoder reads them.
void sort_levels(TileLevels& tile) {
    std::vector<NonZero> sorted;
    sorted.reserve(tile.nonzeros.size());
    for (PlaneLevels& plane : tile.planes) {
        const auto levels = tile.levels(plane);
        plane.first = static_cast<std::uint32_t>(sorted.size());
        sorted.insert(sorted.end(), levels.begin(), levels.end());
    }
    tile.nonzeros.swap(sorted);
}

} // namespace

float TreeEncoder::encode_plain(TileLevels& out, LevelBalance* balance) {
    blocks_.memory = {};
    if (balance != nullptr)
        balance->begin();
    float cost = 0;
    for (const Block& block : out.blocks) {
        cost += blocks_.encode(search, block, {}, decoded, out) + bits_cost(usual_split_bits);
        if (balance != nullptr)
            balance->add(blocks_.coefficients(out.colours.back()));
    }
    return cost;
}

float TreeEncoder::encode_copies(TileLevels& out, Refinement* refinement) {
    out.nonzeros.clear();
    out.order = limit_copy_depths(out.shape, out.blocks, out.predictions).order;
    const auto planes = static_cast<std::size_t>(coding_->planes);
    out.planes.assign(out.blocks.size() * planes, {});
    out.colours.assign(out.blocks.size(), {});
    blocks_.memory = {};
    decoded.resize(out.shape, coding_->planes);
    float cost = 0;
    for (const std::uint16_t i : out.order) {
        const float block_cost =
            encode_best(out.blocks[i], out.predictions[i]) + bits_cost(usual_split_bits);
        cost += block_cost;
        if (refinement != nullptr)
            consider_edits(out, i, block_cost, *refinement);
        put_levels(trial_, 0, planes, i, out);
        out.colours[i] = trial_.colours[0];
        reconstruct_block(out, i, decoded);
    }
    sort_levels(out);
    if (!copies_anything(out.predictions))
        out.forget_copies();
    return cost + (copies_base(out) ? base.cost : 0);
}

// Codes one block into trial_, with its prediction or, if that costs less, without it.
float TreeEncoder::encode_best(const Block& block, BlockPrediction& prediction) {
    trial_.clear();
    const ColourMemory memory_before = blocks_.memory;
    const float chosen = blocks_.encode(search, block, prediction, decoded, trial_);
    if (!prediction.copies())
        return chosen;
    const float copied = chosen + bits_cost(usual_prediction_bits);
    const ColourMemory memory_after = std::exchange(blocks_.memory, memory_before);
    other_trial_.clear();
    const float own = blocks_.encode(search, block, {}, decoded, other_trial_, copied);
    if (own < copied) {
        std::swap(trial_, other_trial_);
        prediction = {};
        return own;
    }
    blocks_.memory = memory_after;
    return copied;
}

float TreeEncoder::encode_picture(const Block& root, const PictureSearch& pictures,
                                  TileLevels& out) {
    return PictureEncoder(*coding_, *costs_, *settings_, pictures, search, blocks_, scratch_,
                          decoded)
        .encode(root, out);
}

bool TreeEncoder::refine(TileLevels& out, float& cost) {
    edited_.clear(); // it may hold a base picture of the tile before
    edited_.shape = out.shape;
    edited_.splits = out.splits;
    edited_.blocks = out.blocks;
    edited_.predictions = out.predictions;
    edited_.predictions.resize(out.blocks.size());
    Refinement refinement{.edits = std::vector<TreeEdit>(out.blocks.size()),
                          .siblings = all_siblings(edited_)};
    encode_copies(edited_, &refinement);
    if (std::ranges::all_of(refinement.edits,
                            [](const TreeEdit& edit) { return edit.kind == TreeEdit::Kind::keep; }))
        return false;
    edited_.predictions.resize(edited_.blocks.size()); // empty if nothing copies
    apply_edits(refinement.edits, edited_);
    if (edited_.blocks.size() + base.levels.blocks.size() > max_leaves)
        return false;
    const float refined = encode_copies(edited_, nullptr);
    if (refined >= cost)
        return false;
    cost = refined;
    std::swap(out, edited_);
    return true;
}

// Whether a block that was coded at `cost` would cost less in four, or with its siblings as one.
// Blocks of one cell of the angular splits copy from other cells only, so siblings are
// reconstructed one after the other, and everything that they or their parent copy is there
// already.
void TreeEncoder::consider_edits(const TileLevels& tile, std::size_t block, float cost,
                                 Refinement& out) {
    std::swap(trial_, kept_trial_);
    const ColourMemory memory = blocks_.memory;
    const auto& n = tile.blocks[block].shape.n;
    const bool is_zero = kept_trial_.nonzeros.empty();
    float least = cost;
    if (!is_zero && std::min(n[0], n[1]) >= smallest_to_split) {
        least = std::min(cost, split_cost(tile.blocks[block], tile.predictions[block], cost));
        if (least < cost)
            out.edits[block].kind = TreeEdit::Kind::split;
    }
    if (const Siblings* siblings = siblings_of(block, out.siblings)) {
        const bool is_first = block == siblings->first;
        out.cost = (is_first ? 0 : out.cost) + least;
        out.are_blank = (is_first || out.are_blank) && is_zero && !tile.predictions[block].copies();
        if (block + 1 == siblings->end() && !out.are_blank)
            consider_merge(tile, *siblings, out);
    }
    blocks_.memory = memory;
    std::swap(trial_, kept_trial_);
}

float TreeEncoder::split_cost(const Block& block, const BlockPrediction& prediction, float enough) {
    const Children quarters = children_of(block, Split::spatial);
    float cost = 0;
    for (int i = 0; i < quarters.count && cost <= enough; ++i) {
        BlockPrediction own = prediction;
        cost +=
            encode_best(quarters.block[i], own) + bits_cost(usual_split_bits + more_blocks_bits);
    }
    return cost;
}

// Tries siblings as one block, with each of their predictions.
void TreeEncoder::consider_merge(const TileLevels& tile, const Siblings& siblings,
                                 Refinement& out) {
    const auto edits = std::span(out.edits).subspan(siblings.first, siblings.count);
    const auto predictions = std::span(tile.predictions).subspan(siblings.first, edits.size());
    TreeEdit best;
    float least = out.cost + bits_cost(more_blocks_bits) * static_cast<float>(siblings.count);
    for (auto i = predictions.begin(); i != predictions.end(); ++i) {
        if (std::find(predictions.begin(), i, *i) != i)
            continue;
        TreeEdit merge{TreeEdit::Kind::merge, *i};
        const float cost =
            encode_best(siblings.parent, merge.prediction) + bits_cost(usual_split_bits);
        if (cost < least) {
            least = cost;
            best = merge;
        }
    }
    if (best.kind != TreeEdit::Kind::merge)
        return;
    std::ranges::fill(edits, TreeEdit{});
    edits.front() = best;
}

void TreeEncoder::encode_again(const TileLevels& tile, TilePlanes& result, MeanDebt* debt,
                               TileLevels& out) {
    const auto planes = static_cast<std::size_t>(coding_->planes);
    out = tile;
    out.nonzeros.clear();
    out.planes.resize(tile.blocks.size() * planes);
    result.done.reset();
    for (std::size_t k = 0; k < tile.blocks.size(); ++k) {
        const std::size_t i = tile.order.empty() ? k : tile.order[k];
        if (i < tile.base_blocks) {
            put_levels(tile, i * planes, planes, i, out);
            continue;
        }
        BlockPrediction prediction =
            tile.predictions.empty() ? BlockPrediction{} : tile.predictions[i];
        const auto encode = [&] {
            search.transform_block(tile.blocks[i], prediction, result, coefficients_);
            // The first coefficient of sines is not the mean.
            if (debt != nullptr && prediction.transform == BlockTransform::cosine)
                debt->ask_of(coefficients_);
            blocks_.encode_as(coefficients_, tile.colours[i], trial_);
        };
        encode();
        if (prediction.transform != BlockTransform::cosine &&
            !blocks_.has_transform_symbol(trial_)) {
            prediction.transform = BlockTransform::cosine;
            out.predictions[i] = prediction;
            encode();
        }
        put_levels(trial_, 0, planes, i, out);
        out.colours[i] = trial_.colours[0];
        reconstruct_block(out, i, result);
        if (debt != nullptr)
            debt->count(tile.blocks[i], decoded, result);
    }
    sort_levels(out);
}

} // namespace tessera
