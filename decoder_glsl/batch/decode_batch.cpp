#include "decoder_glsl/batch/decode_batch.h"

#include "decoder_glsl/shaders/shader_layout.h"
#include "format/tile/limits.h"
#include "format/tile/payload.h"

#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

using namespace layout;

constexpr std::uint32_t raw_chunk = 64;

// Every coefficient that is not 0 takes a whole bit, its sign, from the state, which only words
// refill (FORMAT.md 3.3): a segment holds no more of them than bits.
std::uint32_t levels_bound(std::size_t bytes) {
    const std::size_t levels = std::min<std::size_t>(8 * bytes, max_segment_work);
    return static_cast<std::uint32_t>((levels + raw_chunk - 1) / raw_chunk * raw_chunk);
}

BlockShape shape_of(const Box4& box) {
    BlockShape shape;
    for (std::size_t axis = 0; axis < 4; ++axis)
        shape.n[axis] = static_cast<std::uint8_t>(box.extent()[axis]);
    return shape;
}

} // namespace

BatchBuilder::BatchBuilder(const DecodeTables& tables, const TileGrid& grid,
                           const BatchLimits& limits, const TexelPlan& plan)
    : tables_(tables), grid_(grid), limits_(limits), plan_(plan) {}

BatchBuilder::Size BatchBuilder::empty_size() {
    return {tsr_w_state, 0, tsr_batch_words};
}

// Of a tile's values, kept for its copies or the filter.
std::uint32_t BatchBuilder::value_words(const Entry& entry, std::uint64_t texels) const {
    const TreeSize& tree = entry.tree;
    const bool keeps = !tree.copies.empty() || (tables_.filters() && !entry.is_stored);
    if (tree.base)
        texels += static_cast<std::uint64_t>(tree.base->texels());
    return keeps ? static_cast<std::uint32_t>(texels) * tables_.value_words() : 0;
}

// What a tile adds to the sizes of its batch.
BatchBuilder::Size BatchBuilder::size_of(const Entry& entry, std::size_t bytes,
                                         std::uint64_t texels) const {
    const PayloadParts& parts = entry.parts;
    const TreeSize& tree = entry.tree;
    std::uint64_t raw = 0;
    for (const auto& segment : parts.segments)
        raw += levels_bound(segment.bytes.size());
    const std::uint64_t corrections = parts.corrections.empty() ? 0 : texels * tables_.planes();
    Size size;
    size.work_words = tsr_state_words + std::uint64_t{tree.blocks} * tsr_block_words +
                      std::uint64_t{tree.items} * tsr_item_words + parts.segments.size() +
                      corrections + 2 * raw + value_words(entry, texels);
    size.coefficients = raw;
    size.words = tsr_tile_words + parts.segments.size() * tsr_segment_words +
                 parts.corrections.size() * tsr_correction_words + raw / raw_chunk +
                 tree.copies.size() + (bytes + 3) / 4;
    return size;
}

BatchBuilder::Entry BatchBuilder::entry_of(std::span<const std::byte> payload,
                                           const BlockShape& shape) const {
    Entry entry;
    PayloadParts& parts = entry.parts;
    const auto tree_of = [&](std::span<const std::byte> segment) {
        return tree_size(segment, shape, tables_.code_tables(), static_cast<int>(tables_.planes()),
                         tables_.predicts(), tables_.base());
    };
    entry.is_stored =
        tables_.has_stored_tiles() &&
        payload.size() == static_cast<std::size_t>(shape.texels()) * tables_.texel_bytes();
    if (!entry.is_stored) {
        entry.is_sound = split_payload(payload, shape.texels(), parts).ok() &&
                         (parts.corrections.empty() || tables_.has_corrections());
        if (entry.is_sound)
            entry.tree = tree_of(parts.segments[0].bytes);
        entry.is_sound = entry.is_sound && !entry.tree.too_deep;
    }
    if (!entry.is_sound || entry.is_stored) {
        parts.corrections.clear();
        parts.segments.assign(1, {});
        entry.tree = tree_of({});
    }
    return entry;
}

bool BatchBuilder::add(std::uint64_t tile, std::span<const std::byte> payload,
                       const TexelPlace& place) {
    const BlockShape shape = shape_of(grid_.box(tile));
    const Entry entry = entry_of(payload, shape);
    if (!entry.is_sound)
        payload = {};
    const Size cost = size_of(entry, payload.size(), static_cast<std::uint64_t>(shape.texels()));
    const Size after{size_.work_words + cost.work_words, size_.coefficients + cost.coefficients,
                     size_.words + cost.words};
    if (!tiles_.empty() &&
        (tiles_.size() >= limits_.tiles || after.work_words > limits_.work_words ||
         after.coefficients > limits_.coefficients || after.words > limits_.words))
        return false;
    size_ = after;
    if (!entry.is_sound)
        damaged_.push_back(tile);
    add_records(entry, payload, shape, place);
    tiles_.push_back(tile);
    return true;
}

void BatchBuilder::add_records(const Entry& entry, std::span<const std::byte> payload,
                               const BlockShape& shape, const TexelPlace& place) {
    const PayloadParts& parts = entry.parts;
    const TreeSize& tree = entry.tree;
    const auto slot = static_cast<std::uint32_t>(tiles_.size());
    const auto base = static_cast<std::uint32_t>(payloads_.size());
    const auto byte_of = [&](std::span<const std::byte> part) {
        return part.empty() ? base
                            : base + static_cast<std::uint32_t>(part.data() - payload.data());
    };
    const auto words_of = [](std::span<const std::byte> part) {
        return static_cast<std::uint32_t>(part.size() / 2);
    };
    const auto first_segment =
        static_cast<std::uint32_t>(segment_words_.size() / tsr_segment_words);
    for (std::size_t i = 0; i < parts.segments.size(); ++i) {
        const auto& segment = parts.segments[i];
        const std::uint32_t room = levels_bound(segment.bytes.size());
        const std::uint32_t end =
            i + 1 < parts.segments.size()
                ? static_cast<std::uint32_t>(parts.segments[i + 1].first_block)
                : tsr_none;
        chunk_words_.insert(chunk_words_.end(), room / raw_chunk,
                            first_segment + static_cast<std::uint32_t>(i));
        segment_words_.insert(segment_words_.end(),
                              {slot, byte_of(segment.bytes), words_of(segment.bytes),
                               static_cast<std::uint32_t>(segment.first_block), end, raw_, room});
        raw_ += room;
    }
    most_segments_ = std::max(most_segments_, static_cast<std::uint32_t>(parts.segments.size()));
    std::uint32_t multipliers = tsr_none;
    if (!parts.corrections.empty()) {
        multipliers = multipliers_;
        multipliers_ += static_cast<std::uint32_t>(shape.texels()) * tables_.planes();
        // Chunks without a stream, too: the empty one decodes to the zeros that must stand there.
        for (std::size_t i = 0; i < parts.corrections.size(); ++i)
            correction_words_.insert(correction_words_.end(), {slot, byte_of(parts.corrections[i]),
                                                               words_of(parts.corrections[i]),
                                                               static_cast<std::uint32_t>(i)});
    }
    const bool predicted = !tree.copies.empty();
    const std::uint32_t values = value_words(entry, static_cast<std::uint64_t>(shape.texels()));
    tile_words_.insert(
        tile_words_.end(),
        {tables_.shape_id(shape), first_segment, static_cast<std::uint32_t>(parts.segments.size()),
         place.x, place.y, place.layer, place.u0 | (place.v0 << 16), multipliers, blocks_,
         tree.blocks, predicted ? static_cast<std::uint32_t>(copy_words_.size()) : tsr_none,
         values > 0 ? values_ : tsr_none, tree.base ? tables_.shape_id(*tree.base) : tsr_none,
         entry.is_stored ? base : tsr_none});
    copy_words_.insert(copy_words_.end(), tree.copies.begin(), tree.copies.end());
    values_ += values;
    waves_ = std::max(waves_, tree.waves);
    most_texels_ = std::max(most_texels_, static_cast<std::uint32_t>(shape.texels()));
    blocks_ += tree.blocks;
    items_ += tree.items;
    payloads_.insert(payloads_.end(), payload.begin(), payload.end());
    payloads_.resize((payloads_.size() + 3) / 4 * 4);
}

DecodeBatch BatchBuilder::finish() {
    DecodeBatch batch;
    const auto tiles = static_cast<std::uint32_t>(tiles_.size());
    const auto segments = static_cast<std::uint32_t>(segment_words_.size() / tsr_segment_words);
    batch.most_segments = most_segments_;
    batch.raw_chunks = static_cast<std::uint32_t>(chunk_words_.size());
    batch.corrections = static_cast<std::uint32_t>(correction_words_.size() / tsr_correction_words);
    batch.waves = waves_;
    batch.predicted = !copy_words_.empty();
    batch.most_texels = most_texels_;

    std::vector<std::uint32_t>& words = batch.words;
    words.assign(tsr_batch_words, 0);
    const auto append = [&words](int field, const std::vector<std::uint32_t>& part) {
        words[static_cast<std::size_t>(field)] = static_cast<std::uint32_t>(words.size());
        words.insert(words.end(), part.begin(), part.end());
    };
    append(tsr_b_tile_at, tile_words_);
    append(tsr_b_segment_at, segment_words_);
    append(tsr_b_raw_chunk_at, chunk_words_);
    append(tsr_b_correction_at, correction_words_);
    append(tsr_b_copies_at, copy_words_);
    words[tsr_b_payload_at] = static_cast<std::uint32_t>(words.size());
    words[tsr_b_payload_bytes] = static_cast<std::uint32_t>(payloads_.size());
    words.resize(words.size() + payloads_.size() / 4);
    if (!payloads_.empty())
        std::memcpy(words.data() + words[tsr_b_payload_at], payloads_.data(), payloads_.size());

    words[tsr_b_tiles] = tiles;
    words[tsr_b_raw_chunks] = batch.raw_chunks;
    words[tsr_b_corrections] = batch.corrections;
    words[tsr_b_fold_u] = plan_.fold_u;
    words[tsr_b_fold_v] = plan_.fold_v;
    words[tsr_b_folds_u] = plan_.folds_u;
    words[tsr_b_stride_s] = plan_.stride_s;
    words[tsr_b_stride_t] = plan_.stride_t;
    words[tsr_b_items_room] = items_;
    std::uint32_t at = tsr_w_state + tiles * tsr_state_words;
    const auto place = [&](int field, std::uint32_t count) {
        words[static_cast<std::size_t>(field)] = at;
        at += count;
    };
    place(tsr_b_blocks_at, blocks_ * tsr_block_words);
    place(tsr_b_items_at, items_ * tsr_item_words);
    place(tsr_b_counts_at, segments);
    place(tsr_b_multipliers_at, multipliers_);
    place(tsr_b_raw_at, 2 * raw_);
    place(tsr_b_values_at, values_);
    batch.work_words = at;
    batch.coefficients = raw_;
    batch.tiles = std::move(tiles_);
    batch.damaged = std::move(damaged_);

    tiles_.clear();
    damaged_.clear();
    tile_words_.clear();
    segment_words_.clear();
    chunk_words_.clear();
    correction_words_.clear();
    copy_words_.clear();
    payloads_.clear();
    raw_ = multipliers_ = most_segments_ = blocks_ = items_ = values_ = 0;
    most_texels_ = 0;
    waves_ = 1;
    size_ = empty_size();
    return batch;
}

} // namespace tessera
