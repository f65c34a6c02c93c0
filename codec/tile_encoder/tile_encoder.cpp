#include "codec/tile_encoder/tile_encoder.h"

#include "codec/entropy/tile_entropy.h"
#include "codec/tile_encoder/base_picture.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tessera {
namespace {

constexpr int most_base_rounds = 3; // of improving a base picture; a fourth brings nothing
constexpr int projections = 1;      // of masked texels (codec/DECISIONS.md)
// Masked texels stay as they are if the estimate is below this share of that with a fill.
constexpr float clearly_cheaper = 0.99f;

// Balancing the mean: rounds of coding a tile again, cheapest first, and of moving first levels, as
// rounding and clamping undo a part of each move.
constexpr std::array<double, 4> balancing_gains = {2, 8, 16, 32};
constexpr int level_rounds = 4;
constexpr double balanced_mean =
    0.015; // codes; a smaller error of a channel's mean does not matter
// The same of pictures. Coding one again costs 3 to 6 % of its bits, because what its blocks were
// predicted from has changed.
constexpr double balanced_picture_mean = 0.5;

} // namespace

void TileEncoder::encode(const TileTexels& tile, const BlockShape& shape, TileLevels& out) {
    has_decoded_ = false;
    if (tile.matters.empty()) {
        take_whole(tile, shape);
        encode_taken(true, out);
    } else {
        encode_masked(tile, shape, out);
    }
    if (settings_->balance && !colour_->corrections && !out.nonzeros.empty())
        balance(tile, out);
}

bool TileEncoder::take_decoded(std::vector<std::byte>& texels) {
    if (has_decoded_)
        texels.swap(meter_.texels());
    return std::exchange(has_decoded_, false);
}

void TileEncoder::encode_as(const TileTexels& tile, const TileLevels& known, TileLevels& out) {
    has_decoded_ = false;
    fill_planes(tile, known.shape);
    encode_again(known, out);
}

// Encodes planes_ with the blocks, copies and colours of `known`.
void TileEncoder::encode_again(const TileLevels& known, TileLevels& out) {
    if (known.second_tree > 0) {
        plane_trees_.encode_again(planes_, known, out);
        return;
    }
    tree_.search.set_tile(planes_);
    balanced_.resize(known.shape, coding_->planes);
    if (known.base_blocks > 0) {
        balanced_.resize_base(*base_shape(known.shape, coding_->parameters.base), coding_->planes);
        for (std::size_t block = 0; block < known.base_blocks; ++block)
            tree_.reconstruct_block(known, block, balanced_);
    }
    tree_.encode_again(known, balanced_, nullptr, out);
}

float TileEncoder::estimate(const TileTexels& tile, const BlockShape& shape, TileLevels& scratch) {
    if (tile.matters.empty()) {
        take_whole(tile, shape);
    } else {
        fill_planes(tile, shape);
        tree_.search.set_tile(planes_);
    }
    return tree_.search.choose_blocks(scratch);
}

// A tile without a mask.
void TileEncoder::take_whole(const TileTexels& tile, const BlockShape& shape) {
    const bool needs_planes = settings_->filter || settings_->search.copies.along != 0;
    if (!needs_planes && tree_.search.set_texels(tile.texels, *colour_, shape))
        return;
    planes_from_texels(tile.texels, *colour_, shape, planes_);
    tree_.search.set_tile(planes_);
}

// Masked texels continue their neighbours.
void TileEncoder::fill_planes(const TileTexels& tile, const BlockShape& shape) {
    planes_from_texels(tile.texels, *colour_, shape, planes_);
    if (tile.matters.empty())
        return;
    dont_care_.set(tile.matters, shape);
    dont_care_.fill(planes_, coding_->planes);
}

// Encodes the tile with its masked texels filled or, unless these are all alike, as they are if
// that is cheaper: they may continue their neighbours as no fill can guess. The tile is encoded
// again with masked texels as it decodes them. Its blocks stay, because a search for others saves
// nothing.
void TileEncoder::encode_masked(const TileTexels& tile, const BlockShape& shape, TileLevels& out) {
    planes_from_texels(tile.texels, *colour_, shape, planes_);
    dont_care_.set(tile.matters, shape);
    if (dont_care_.is_all() || dont_care_.are_alike(planes_, coding_->planes)) {
        dont_care_.fill(planes_, coding_->planes);
        encode_planes(out);
    } else if (settings_->code_both_fills) {
        encode_cheaper_fill(out);
    } else {
        encode_likely_fill(out);
    }
    for (int round = 0; round < projections; ++round) {
        tree_.reconstruct(out);
        dont_care_.project(tree_.decoded, planes_, coding_->planes);
        if (moves_levels()) { // level_balance_ has to know the blocks
            encode_planes(out);
            continue;
        }
        encode_again(out, copies_);
        std::swap(out, copies_);
    }
}

void TileEncoder::encode_cheaper_fill(TileLevels& out) {
    TilePlanes own = planes_;
    const float as_it_is = encode_planes(out);
    TileLevels own_levels = out;
    dont_care_.fill(planes_, coding_->planes);
    if (encode_planes(out) > as_it_is) {
        std::swap(planes_, own);
        std::swap(out, own_levels);
    }
}

// The same, but the estimates of the block search decide. They do not know copies, which mostly
// favour the fill.
void TileEncoder::encode_likely_fill(TileLevels& out) {
    tree_.search.set_tile(planes_);
    const float as_it_is = tree_.search.choose_blocks(out);
    TilePlanes own = planes_;
    dont_care_.fill(planes_, coding_->planes);
    tree_.search.set_tile(planes_);
    const bool fills = clearly_cheaper * tree_.search.choose_blocks(out) <= as_it_is;
    if (fills && !is_coded_as_picture()) {
        encode_blocks(false, out);
        return;
    }
    if (!fills)
        std::swap(planes_, own);
    encode_planes(out);
}

float TileEncoder::encode_planes(TileLevels& out) {
    tree_.search.set_tile(planes_);
    return encode_taken(false, out);
}

// Encodes the tile that the search has taken. Returns its cost: squared steps, plus lambda for
// every bit.
float TileEncoder::encode_taken(bool is_whole, TileLevels& out) {
    if (is_coded_as_picture())
        return encode_picture(out);
    tree_.search.choose_blocks(out);
    return encode_blocks(is_whole, out);
}

// The same for a picture: with one tree or with one for each plane, as a quick search decides.
float TileEncoder::encode_picture(TileLevels& out) {
    const PictureSearch& full = settings_->pictures;
    if (!coding_->parameters.plane_trees)
        return encode_one_tree(full, out);
    PictureSearch quick = settings_->quick_pictures();
    quick.directions = quick.directions && full.careful_trees;
    const float shared = encode_one_tree(quick, out);
    if (plane_trees_.encode(planes_, quick, out) >= shared)
        return encode_one_tree(full, out);
    const float cost = plane_trees_.encode(planes_, full, out);
    return out.blocks.size() <= max_leaves ? cost : encode_one_tree(full, out);
}

float TileEncoder::encode_one_tree(const PictureSearch& search, TileLevels& out) {
    tree_.begin_tile(false, true);
    return tree_.encode_picture({.shape = planes_.shape}, search, out);
}

// The same from the blocks of BlockSearch::choose_blocks on.
float TileEncoder::encode_blocks(bool is_whole, TileLevels& out) {
    const bool copies = searches_copies();
    tree_.begin_tile(copies, copies || !is_whole);
    float cost = tree_.encode_plain(out, &level_balance_);
    if (!copies)
        return cost;
    // Blocks first copy from the tile as it is without copies, then as it is after the last round,
    // which is closer to what the decoder has. The cheapest round stays.
    tree_.reconstruct(out);
    const bool can_have_base = base_shape(out.shape, coding_->parameters.base).has_value();
    const int copy_rounds = can_have_base ? 1 : settings_->copy_rounds; // more bring nothing then
    for (int round = 0; round < copy_rounds; ++round) {
        if (!tree_.search.choose_copies(tree_.decoded, copies_))
            break;
        const float with_copies = tree_.encode_copies(copies_);
        if (with_copies < cost) {
            cost = with_copies;
            std::swap(out, copies_);
        }
    }
    if (can_have_base && !out.nonzeros.empty())
        try_base(out, cost);
    for (int round = 0; round < settings_->refinements && !out.nonzeros.empty(); ++round)
        if (!tree_.refine(out, cost))
            break;
    if (copies_base(out))
        prepend_base(tree_.base.levels, out);
    return cost;
}

// Tries a base picture that all views copy. Its margin shows what moves in from other views, so it
// depends on the displacements, which at first are those of the middle view's own texels.
void TileEncoder::try_base(TileLevels& out, float& cost) {
    CodedBase& base = tree_.base;
    TilePlanes& decoded = tree_.decoded;
    base_tree_.search.set_fineness(base_fineness(out.shape));
    BaseDisplacements displacements(out.shape);
    tree_.reconstruct(out);
    const auto make_picture = [&] {
        make_base_picture(planes_, coding_->planes, coding_->parameters.base, displacements,
                          picture_);
    };
    make_picture();
    decoded.base_shape = picture_.shape;
    decoded.base = picture_.plane;
    tree_.search.find_displacements(decoded, displacements);
    CodedBase kept;
    const int rounds = std::min(settings_->copy_rounds, most_base_rounds);
    for (int round = 0; round < rounds; ++round) {
        const bool is_last = round + 1 == rounds;
        if (round > 0) // views that copy the base picture are better to copy from
            tree_.search.choose_copies(decoded, copies_);
        make_picture();
        encode_base(picture_, is_last && !settings_->quick_bases ? settings_->pictures
                                                                 : settings_->quick_pictures());
        if (!tree_.search.choose_base_copies(decoded, copies_) ||
            copies_.blocks.size() + base.levels.blocks.size() > max_leaves)
            break;
        displacements.take(copies_);
        const float with_base = tree_.encode_copies(copies_);
        if (with_base < cost) {
            cost = with_base;
            std::swap(out, copies_);
            std::swap(kept, base);
        }
    }
    std::swap(base, kept);
    if (copies_base(out))
        decode_base();
}

// Codes a base picture and puts it into tree_.decoded.
void TileEncoder::encode_base(const TilePlanes& picture, const PictureSearch& search) {
    CodedBase& base = tree_.base;
    base_tree_.search.set_tile(picture);
    base_tree_.begin_tile(false, true);
    base_tree_.encode_picture(base_root(picture.shape), search, base.levels);
    base_bytes_.clear();
    encode_levels(base.levels, {}, *coding_, base_bytes_);
    base.cost = settings_->quantizer.lambda * 8 * static_cast<float>(base_bytes_.size());
    decode_base();
}

void TileEncoder::decode_base() {
    TileLevels alone;
    alone.shape = planes_.shape;
    prepend_base(tree_.base.levels, alone);
    tree_.decoded.resize_base(tree_.base.levels.shape, coding_->planes);
    for (std::size_t block = 0; block < alone.base_blocks; ++block)
        tree_.reconstruct_block(alone, block, tree_.decoded);
}

// Brings the tile's mean colour closer to that of its texels: by moving first levels if each of
// them changes one block only, otherwise by coding the tile again.
void TileEncoder::balance(const TileTexels& tile, TileLevels& out) {
    tree_.reconstruct(out);
    Means error = meter_.error(tile, tree_.decoded);
    has_decoded_ = true;
    if (moves_levels()) {
        for (int round = 0; round < level_rounds && largest_of(error) > balanced_mean; ++round)
            if (!balance_levels(tile, error, out))
                return;
        return;
    }
    const double enough = is_coded_as_picture() ? balanced_picture_mean : balanced_mean;
    for (const double gain : balancing_gains)
        if (largest_of(error) > enough)
            balance_again(tile, error, gain, out);
}

// False if no level could be moved or that did not help.
bool TileEncoder::balance_levels(const TileTexels& tile, Means& error, TileLevels& out) {
    copies_ = out;
    const std::vector<std::size_t>& changed = level_balance_.pay(error, tile, out);
    if (changed.empty())
        return false;
    for (const std::size_t block : changed)
        tree_.reconstruct_block(out, block, tree_.decoded);
    const Means now = meter_.error(tile, tree_.decoded);
    has_decoded_ = largest_of(now) < largest_of(error);
    if (has_decoded_)
        error = now;
    else
        std::swap(out, copies_);
    return has_decoded_;
}

// Keeps the result only if it is closer. It may not be: one level of a block can be too much, and
// the debt can be too small to change any.
void TileEncoder::balance_again(const TileTexels& tile, Means& error, double gain,
                                TileLevels& out) {
    balanced_ = tree_.decoded;
    if (out.second_tree > 0) {
        plane_trees_.balance(out, error, gain, balanced_, copies_);
    } else {
        MeanDebt debt{error, out.shape.texels(), gain, *coding_, *colour_};
        tree_.encode_again(out, balanced_, &debt, copies_);
    }
    const Means now = meter_.error(tile, balanced_);
    has_decoded_ = largest_of(now) < largest_of(error);
    if (!has_decoded_)
        return;
    error = now;
    std::swap(out, copies_);
    std::swap(tree_.decoded, balanced_);
}

} // namespace tessera
