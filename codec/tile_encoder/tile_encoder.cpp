#include "codec/tile_encoder/tile_encoder.h"

#include "codec/entropy/tile_entropy.h"
#include "codec/tile_encoder/base_picture.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace tessera {
namespace {

// Of a block that copies, beside its levels: what encode_best takes them for.
constexpr float usual_prediction_bits = 6.0f;
constexpr float usual_split_bits = 1.3f; // of a block's share of the split tree
constexpr float more_blocks_bits = 1.0f; // of a quarter, beside what encode_best sees
constexpr int smallest_to_split = 8;     // side of a block, as the search goes down to 4

constexpr int most_base_rounds = 3; // of making a base picture; a fourth brings nothing

// Rounds of coding a tile again. What costs less comes first.
constexpr std::array<double, 3> balancing_gains = {2, 8, 16};
// Rounds of moving first levels: flat blocks are rounded, dark ones clamped.
constexpr int level_rounds = 4;
constexpr double balanced_mean = 0.015; // codes by which no channel matters

constexpr int projections = 1; // of texels that do not matter (codec/DECISIONS.md)

// Levels in the order of the blocks, as a decoder reads them.
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

void TileEncoder::encode(const TileTexels& tile, const BlockShape& shape, TileLevels& out) {
    has_decoded_ = false;
    encode_all(tile, shape, out);
    if (settings_->balance && !colour_->corrections && !out.nonzeros.empty())
        balance(tile, out);
}

bool TileEncoder::take_decoded(std::vector<std::byte>& texels) {
    if (has_decoded_)
        texels.swap(meter_.texels());
    return std::exchange(has_decoded_, false);
}

void TileEncoder::encode_all(const TileTexels& tile, const BlockShape& shape, TileLevels& out) {
    is_whole_ = tile.matters.empty();
    if (is_whole_) {
        take_whole(tile, shape);
        encode_taken(out);
        return;
    }
    planes_from_texels(tile.texels, *colour_, shape, planes_);
    dont_care_.set(tile.matters, shape);
    encode_filled(out);
    for (int round = 0; round < projections; ++round) {
        reconstruct(out, *coding_, scratch_, decoded_);
        dont_care_.project(decoded_, planes_, coding_->planes);
        encode_planes(out);
    }
}

void TileEncoder::take_whole(const TileTexels& tile, const BlockShape& shape) {
    const bool needs_planes = settings_->filter || settings_->search.copies.along != 0;
    if (!needs_planes && search_.set_texels(tile.texels, *colour_, shape))
        return;
    planes_from_texels(tile.texels, *colour_, shape, planes_);
    search_.set_tile(planes_);
}

// What does not matter goes on from what is beside it.
void TileEncoder::fill_planes(const TileTexels& tile, const BlockShape& shape) {
    planes_from_texels(tile.texels, *colour_, shape, planes_);
    if (tile.matters.empty())
        return;
    dont_care_.set(tile.matters, shape);
    dont_care_.fill(planes_, coding_->planes);
}

void TileEncoder::encode_as(const TileTexels& tile, const TileLevels& known, TileLevels& out) {
    has_decoded_ = false;
    fill_planes(tile, known.shape);
    search_.set_tile(planes_);
    balanced_.resize(known.shape, coding_->planes);
    if (known.base_blocks > 0) {
        balanced_.resize_base(*base_shape(known.shape, coding_->parameters.base), coding_->planes);
        for (std::size_t block = 0; block < known.base_blocks; ++block)
            reconstruct_block(known, block, *coding_, scratch_, balanced_);
    }
    encode_again(known, nullptr, out);
}

float TileEncoder::estimate(const TileTexels& tile, const BlockShape& shape, TileLevels& scratch) {
    if (tile.matters.empty()) {
        take_whole(tile, shape);
    } else {
        fill_planes(tile, shape);
        search_.set_tile(planes_);
    }
    return search_.choose_blocks(scratch);
}

// Where something is behind a mask it may go on from what is beside it, as no fill can guess: then both
// are encoded, and the cheaper one stays.
void TileEncoder::encode_filled(TileLevels& out) {
    if (dont_care_.is_all() || dont_care_.are_alike(planes_, coding_->planes)) {
        dont_care_.fill(planes_, coding_->planes);
        encode_planes(out);
        return;
    }
    TilePlanes own = planes_;
    const float as_it_is = encode_planes(out);
    TileLevels own_levels = out;
    dont_care_.fill(planes_, coding_->planes);
    if (encode_planes(out) <= as_it_is)
        return;
    std::swap(planes_, own);
    std::swap(out, own_levels);
}

float TileEncoder::encode_planes(TileLevels& out) {
    search_.set_tile(planes_);
    return encode_taken(out);
}

// The tile that search_ has taken. Returns what it costs: squared steps, a bit being worth lambda of them.
float TileEncoder::encode_taken(TileLevels& out) {
    const bool copies = coding_->predicts && settings_->search.copies.along != 0;
    compares_ = copies || !is_whole_;
    coded_.begin(copies);
    search_.choose_blocks(out);
    float cost = encode_blocks(search_, coded_, out);
    if (!copies)
        return cost;
    // What the tile looks like without copies stands for what its blocks could copy; what it then
    // looks like, in a further round, is nearer to the truth. The cheapest of all rounds stays.
    reconstruct(out, *coding_, scratch_, decoded_);
    const bool can_have_base = base_shape(out.shape, coding_->parameters.base).has_value();
    const int copy_rounds = can_have_base ? 1 : settings_->copy_rounds; // the others bring nothing
    for (int round = 0; round < copy_rounds; ++round) {
        if (!search_.choose_copies(decoded_, copies_))
            break;
        const float with_copies = encode_copies(copies_);
        if (with_copies < cost) {
            cost = with_copies;
            std::swap(out, copies_);
        }
    }
    base_.levels.clear();
    if (can_have_base && !out.nonzeros.empty())
        try_base(out, cost);
    for (int round = 0; round < settings_->refinements && !out.nonzeros.empty(); ++round)
        if (!refine(out, cost))
            break;
    if (copies_base(out))
        prepend_base(base_.levels, out);
    return cost;
}

// Codes a base picture, which decoded_ has then.
void TileEncoder::encode_base(const TilePlanes& picture) {
    base_search_.set_tile(picture);
    base_search_.choose_blocks(base_.levels);
    base_coded_.begin(false);
    encode_blocks(base_search_, base_coded_, base_.levels);
    base_bytes_.clear();
    encode_levels(base_.levels, {}, *coding_, base_bytes_);
    base_.cost = settings_->quantizer.lambda * 8 * static_cast<float>(base_bytes_.size());
    decode_base();
}

void TileEncoder::decode_base() {
    TileLevels alone;
    alone.shape = planes_.shape;
    prepend_base(base_.levels, alone);
    decoded_.resize_base(base_.levels.shape, coding_->planes);
    for (std::size_t block = 0; block < alone.base_blocks; ++block)
        reconstruct_block(alone, block, *coding_, scratch_, decoded_);
}

// A picture that all views copy. How its parts move says what is in its margin: at first as the middle
// view's own texels match the others.
void TileEncoder::try_base(TileLevels& out, float& cost) {
    base_search_.set_fineness(base_fineness(out.shape));
    BaseDisplacements displacements(out.shape);
    reconstruct(out, *coding_, scratch_, decoded_);
    const auto make_picture = [&] {
        make_base_picture(planes_, coding_->planes, coding_->parameters.base, displacements,
                          picture_);
    };
    make_picture();
    decoded_.base_shape = picture_.shape;
    decoded_.base = picture_.plane;
    search_.find_displacements(decoded_, displacements);
    Base kept;
    for (int round = 0; round < std::min(settings_->copy_rounds, most_base_rounds); ++round) {
        if (round > 0) // views that copy the base picture are better ones to copy
            search_.choose_copies(decoded_, copies_);
        make_picture();
        encode_base(picture_);
        if (!search_.choose_base_copies(decoded_, copies_) ||
            copies_.blocks.size() + base_.levels.blocks.size() > max_leaves)
            break;
        displacements.take(copies_);
        const float with_base = encode_copies(copies_);
        if (with_base < cost) {
            cost = with_base;
            std::swap(out, copies_);
            std::swap(kept, base_);
        }
    }
    std::swap(base_, kept);
    if (copies_base(out))
        decode_base();
}

// The search goes by estimates. Coding the tree that it chose, and each block's quarters and
// parent beside it, shows where these were wrong. False if nothing is to be gained.
bool TileEncoder::refine(TileLevels& out, float& cost) {
    copies_.clear(); // of the tile before, it may have a base picture
    copies_.shape = out.shape;
    copies_.splits = out.splits;
    copies_.blocks = out.blocks;
    copies_.predictions = out.predictions;
    copies_.predictions.resize(out.blocks.size());
    Refinement refinement{std::vector<TreeEdit>(out.blocks.size()), all_siblings(copies_)};
    encode_copies(copies_, &refinement);
    if (std::all_of(refinement.edits.begin(), refinement.edits.end(),
                    [](const TreeEdit& edit) { return edit.kind == TreeEdit::Kind::keep; }))
        return false;
    copies_.predictions.resize(copies_.blocks.size()); // forgotten where nothing copies
    apply_edits(refinement.edits, copies_);
    if (copies_.blocks.size() + base_.levels.blocks.size() > max_leaves)
        return false;
    const float refined = encode_copies(copies_);
    if (refined >= cost)
        return false;
    cost = refined;
    std::swap(out, copies_);
    return true;
}

// Returns the tile's cost, as encode_copies does.
float TileEncoder::encode_blocks(BlockSearch& search, CodedBlocks& coded, TileLevels& out) {
    last_rotation_ = 1;
    float cost = 0;
    level_balance_.begin();
    for (const Block& block : out.blocks) {
        cost += encode_block(search, coded, block, {}, out) +
                settings_->quantizer.lambda * usual_split_bits;
        level_balance_.add(out.colours.back() != 0 ? rotated_ : coefficients_);
    }
    return cost;
}

// Closed loop: each block copies from what the decoder will have.
float TileEncoder::encode_copies(TileLevels& out, Refinement* refinement) {
    out.nonzeros.clear();
    out.order = limit_copy_depths(out.shape, out.blocks, out.predictions).order;
    const auto planes = static_cast<std::size_t>(coding_->planes);
    out.planes.assign(out.blocks.size() * planes, {});
    out.colours.assign(out.blocks.size(), 0);
    last_rotation_ = 1;
    decoded_.resize(out.shape, coding_->planes);
    float cost = 0;
    for (const std::uint16_t i : out.order) {
        const float block_cost = encode_best(out.blocks[i], out.predictions[i]) +
                                 settings_->quantizer.lambda * usual_split_bits;
        cost += block_cost;
        if (refinement != nullptr)
            consider_edits(out, i, block_cost, *refinement);
        for (std::size_t plane = 0; plane < planes; ++plane) {
            out.planes[i * planes + plane] = trial_.planes[plane];
            out.planes[i * planes + plane].first += static_cast<std::uint32_t>(out.nonzeros.size());
        }
        out.colours[i] = trial_.colours[0];
        out.nonzeros.insert(out.nonzeros.end(), trial_.nonzeros.begin(), trial_.nonzeros.end());
        reconstruct_block(out, i, *coding_, scratch_, decoded_);
    }
    sort_levels(out);
    if (!copies_anything(out.predictions))
        out.forget_copies();
    return cost + (copies_base(out) ? base_.cost : 0);
}

// After a block was coded at `cost`: would it be cheaper in four, or with its siblings as one?
// Blocks of one cell of the angular splits copy from other cells only, so siblings are reconstructed
// one after the other, and what any of them or their parent would copy is there already.
void TileEncoder::consider_edits(const TileLevels& tile, std::size_t block, float cost,
                                 Refinement& out) {
    std::swap(trial_, kept_trial_);
    const int rotation = last_rotation_;
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
    last_rotation_ = rotation;
    std::swap(trial_, kept_trial_);
}

float TileEncoder::split_cost(const Block& block, const BlockPrediction& prediction, float enough) {
    const Children quarters = children_of(block, Split::spatial);
    float cost = 0;
    for (int i = 0; i < quarters.count && cost <= enough; ++i) {
        BlockPrediction own = prediction;
        cost += encode_best(quarters.block[static_cast<std::size_t>(i)], own) +
                settings_->quantizer.lambda * (usual_split_bits + more_blocks_bits);
    }
    return cost;
}

// Siblings as one block, with each of the predictions that they have.
void TileEncoder::consider_merge(const TileLevels& tile, const Siblings& siblings,
                                 Refinement& out) {
    const auto edits = std::span(out.edits).subspan(siblings.first, siblings.count);
    const auto predictions = std::span(tile.predictions).subspan(siblings.first, edits.size());
    TreeEdit best;
    float least = out.cost + settings_->quantizer.lambda * more_blocks_bits *
                                 static_cast<float>(siblings.count);
    for (auto i = predictions.begin(); i != predictions.end(); ++i) {
        if (std::find(predictions.begin(), i, *i) != i)
            continue;
        TreeEdit merge{TreeEdit::Kind::merge, *i};
        const float cost = encode_best(siblings.parent, merge.prediction) +
                           settings_->quantizer.lambda * usual_split_bits;
        if (cost < least) {
            least = cost;
            best = merge;
        }
    }
    if (best.kind != TreeEdit::Kind::merge)
        return;
    std::fill(edits.begin(), edits.end(), TreeEdit{});
    edits.front() = best;
}

// One block into trial_, with its prediction or, where that turns out cheaper, without.
float TileEncoder::encode_best(const Block& block, BlockPrediction& prediction) {
    trial_.clear();
    const int rotation_before = last_rotation_;
    const float chosen = encode_block(search_, coded_, block, prediction, trial_);
    if (!prediction.copies())
        return chosen;
    const float copied = chosen + settings_->quantizer.lambda * usual_prediction_bits;
    const int rotation_after = last_rotation_;
    last_rotation_ = rotation_before;
    other_trial_.clear();
    const float own = encode_block(search_, coded_, block, {}, other_trial_, copied);
    if (own < copied) {
        std::swap(trial_, other_trial_);
        prediction = {};
        return own;
    }
    last_rotation_ = rotation_after;
    return copied;
}

void TileEncoder::balance(const TileTexels& tile, TileLevels& out) {
    reconstruct(out, *coding_, scratch_, decoded_);
    Means error = meter_.error(tile, decoded_);
    has_decoded_ = true;
    if (has_free_levels()) {
        for (int round = 0; round < level_rounds && largest_of(error) > balanced_mean; ++round)
            if (!balance_levels(tile, error, out))
                return;
        return;
    }
    for (const double gain : balancing_gains)
        if (largest_of(error) > balanced_mean)
            balance_again(tile, error, gain, out);
}

// False if nothing came of it.
bool TileEncoder::balance_levels(const TileTexels& tile, Means& error, TileLevels& out) {
    copies_ = out;
    const std::vector<std::size_t>& changed = level_balance_.pay(error, tile, out);
    if (changed.empty())
        return false;
    for (const std::size_t block : changed)
        reconstruct_block(out, block, *coding_, scratch_, decoded_);
    const Means now = meter_.error(tile, decoded_);
    has_decoded_ = largest_of(now) < largest_of(error);
    if (has_decoded_)
        error = now;
    else
        std::swap(out, copies_);
    return has_decoded_;
}

void TileEncoder::balance_again(const TileTexels& tile, Means& error, double gain,
                                TileLevels& out) {
    MeanDebt debt{error, out.shape.texels(), gain, *coding_, *colour_};
    balanced_ = decoded_;
    encode_again(out, &debt, copies_);
    const Means now = meter_.error(tile, balanced_);
    has_decoded_ = largest_of(now) < largest_of(error);
    if (!has_decoded_)
        return; // one level of a block is too much, or too little was asked for
    error = now;
    std::swap(out, copies_);
    std::swap(decoded_, balanced_);
}

// Codes the blocks of a tile as they are but for their levels; those of a base picture stay, and balanced_
// has it. balanced_ has what comes out. debt: of a tile that decoded_ has; or nullptr.
void TileEncoder::encode_again(const TileLevels& tile, MeanDebt* debt, TileLevels& out) {
    const auto planes = static_cast<std::size_t>(coding_->planes);
    out = tile;
    out.nonzeros.clear();
    const auto put = [&](std::size_t block, const TileLevels& from, std::size_t first_plane) {
        for (std::size_t p = 0; p < planes; ++p) {
            PlaneLevels plane = from.planes[first_plane + p];
            const auto levels = from.levels(plane);
            plane.first = static_cast<std::uint32_t>(out.nonzeros.size());
            out.planes[block * planes + p] = plane;
            out.nonzeros.insert(out.nonzeros.end(), levels.begin(), levels.end());
        }
    };
    out.planes.resize(tile.blocks.size() * planes);
    for (std::size_t k = 0; k < tile.blocks.size(); ++k) {
        const std::size_t i = tile.order.empty() ? k : tile.order[k];
        if (i < tile.base_blocks) {
            put(i, tile, i * planes);
            continue;
        }
        const BlockPrediction prediction =
            tile.predictions.empty() ? BlockPrediction{} : tile.predictions[i];
        search_.transform_block(tile.blocks[i], prediction, balanced_, coefficients_);
        if (debt != nullptr)
            debt->ask_of(coefficients_);
        encode_coloured(tile.colours[i]);
        put(i, trial_, 0);
        out.colours[i] = trial_.colours[0];
        reconstruct_block(out, i, *coding_, scratch_, balanced_);
        if (debt != nullptr)
            debt->count(tile.blocks[i], decoded_, balanced_);
    }
    sort_levels(out);
}

// coefficients_ into trial_, on the axes of that colour unless its first plane would be empty then.
void TileEncoder::encode_coloured(int colour) {
    trial_.clear();
    if (colour != 0) {
        rotate_colours(coefficients_, colour - 1, rotated_);
        quantizer_.quantize(rotated_, trial_);
        if (trial_.planes[0].coded_length != 0)
            return;
        trial_.clear();
    }
    quantizer_.quantize(coefficients_, trial_);
}

} // namespace tessera
