#include "decoder_glsl/batch/decode_batch.h"

#include "decoder_glsl/shaders/shader_layout.h"
#include "format/tile/limits.h"
#include "format/tile/payload.h"

#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

using namespace layout;

// A bound on the levels of a segment, rounded up to whole chunks. Every coefficient that is not 0
// takes a whole bit from the entropy state, its sign, and only words of the segment refill that
// state (FORMAT.md 3.3): so a segment has no more of them than bits.
std::uint32_t levels_bound(std::size_t bytes) {
    const std::size_t levels = std::min<std::size_t>(8 * bytes, max_segment_work);
    return static_cast<std::uint32_t>((levels + tsr_raw_chunk - 1) / tsr_raw_chunk * tsr_raw_chunk);
}

BlockShape shape_of(const Box4& box) {
    BlockShape shape;
    for (std::size_t axis = 0; axis < 4; ++axis)
        shape.n[axis] = static_cast<std::uint16_t>(box.extent()[axis]);
    return shape;
}

std::uint32_t count_of(std::size_t words, int each) {
    return static_cast<std::uint32_t>(words / static_cast<std::size_t>(each));
}

std::uint32_t words_of(std::span<const std::byte> stream) {
    return static_cast<std::uint32_t>(stream.size() / 2);
}

// Appends a record of `count` words, 0 at first, and returns a pointer to it.
std::uint32_t* append_record(std::vector<std::uint32_t>& words, int count) {
    words.resize(words.size() + static_cast<std::size_t>(count), 0);
    return words.data() + words.size() - count;
}

} // namespace

BatchBuilder::BatchBuilder(DecodeTables& tables, const TileGrid& grid, const BatchLimits& limits,
                           const TexelPlan& plan)
    : tables_(tables), grid_(grid), limits_(limits), plan_(plan) {}

BatchBuilder::Size BatchBuilder::empty_size() {
    return {.work_words = tsr_w_state, .coefficients = 0, .words = tsr_batch_words};
}

// Words that a tile keeps its values in.
std::uint32_t BatchBuilder::value_words(const Entry& entry, std::uint64_t texels) const {
    const TreeSize& tree = entry.tree;
    const bool keeps = !tree.copies.empty() || (tables_.filters() && !entry.is_stored);
    if (tree.base)
        texels += static_cast<std::uint64_t>(tree.base->texels());
    return keeps ? static_cast<std::uint32_t>(texels) * tables_.value_words() : 0;
}

// The words and coefficients that a tile adds to a batch.
BatchBuilder::Size BatchBuilder::size_of(const Entry& entry, std::size_t bytes,
                                         std::uint64_t texels) const {
    const PayloadParts& parts = entry.parts;
    const TreeSize& tree = entry.tree;
    std::uint64_t raw = 0;
    for (const auto& segment : parts.segments)
        raw += levels_bound(segment.bytes.size());
    const std::uint64_t corrections = parts.corrections.empty() ? 0 : texels * tables_.planes();
    return {.work_words = tsr_state_words + std::uint64_t{tree.blocks} * tsr_block_words +
                          std::uint64_t{tree.items} * tsr_item_words + parts.segments.size() +
                          corrections + tsr_raw_words * raw + value_words(entry, texels),
            .coefficients = raw,
            .words = tsr_tile_words + parts.segments.size() * tsr_segment_words +
                     parts.corrections.size() * tsr_correction_words + raw / tsr_raw_chunk +
                     tree.copies.size() + tree.borders.size() + (bytes + 3) / 4};
}

BatchBuilder::Entry BatchBuilder::entry_of(std::span<const std::byte> payload,
                                           const BlockShape& shape) const {
    Entry entry;
    PayloadParts& parts = entry.parts;
    const auto tree_of = [&](std::span<const std::byte> segment) {
        return tree_size(segment, shape, tables_.code_tables(), static_cast<int>(tables_.planes()),
                         tables_.predicts(), tables_.plane_trees(), tables_.base());
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
    const Size& now = content_.size;
    const Size after{.work_words = now.work_words + cost.work_words,
                     .coefficients = now.coefficients + cost.coefficients,
                     .words = now.words + cost.words};
    if (!empty() &&
        (content_.tiles.size() >= limits_.tiles || after.work_words > limits_.work_words ||
         after.coefficients > limits_.coefficients || after.words > limits_.words))
        return false;
    if (!tables_.add_scans(entry.tree.shapes)) {
        if (!empty())
            return false; // the tiles before it need the tables that are there
        tables_.forget_scans();
        tables_.add_scans(entry.tree.shapes);
    }
    content_.size = after;
    if (!entry.is_sound)
        content_.damaged.push_back(tile);
    add_tile(entry, payload, shape, place);
    content_.tiles.push_back(tile);
    return true;
}

std::uint32_t BatchBuilder::byte_of(std::span<const std::byte> payload,
                                    std::span<const std::byte> part) const {
    const auto base = static_cast<std::uint32_t>(content_.payloads.size());
    return part.empty() ? base : base + static_cast<std::uint32_t>(part.data() - payload.data());
}

void BatchBuilder::add_segments(const Entry& entry, std::span<const std::byte> payload) {
    Content& c = content_;
    const auto& segments = entry.parts.segments;
    const auto tile = static_cast<std::uint32_t>(c.tiles.size());
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const std::uint32_t room = levels_bound(segments[i].bytes.size());
        c.chunk_words.insert(c.chunk_words.end(), room / tsr_raw_chunk,
                             count_of(c.segment_words.size(), tsr_segment_words));
        std::uint32_t* record = append_record(c.segment_words, tsr_segment_words);
        record[tsr_seg_tile] = tile;
        record[tsr_seg_byte] = byte_of(payload, segments[i].bytes);
        record[tsr_seg_size] = words_of(segments[i].bytes);
        record[tsr_seg_first] = static_cast<std::uint32_t>(segments[i].first_block);
        record[tsr_seg_end] = i + 1 < segments.size()
                                  ? static_cast<std::uint32_t>(segments[i + 1].first_block)
                                  : tsr_none;
        record[tsr_seg_raw] = c.raw;
        record[tsr_seg_room] = room;
        c.raw += room;
    }
    c.most_segments = std::max(c.most_segments, static_cast<std::uint32_t>(segments.size()));
}

// Returns the word of the tile's multipliers, or tsr_none.
std::uint32_t BatchBuilder::add_corrections(const Entry& entry, std::span<const std::byte> payload,
                                            const BlockShape& shape) {
    Content& c = content_;
    const auto& streams = entry.parts.corrections;
    if (streams.empty())
        return tsr_none;
    // An empty stream is decoded too: it gives the zeros of its chunk.
    for (std::size_t i = 0; i < streams.size(); ++i) {
        std::uint32_t* record = append_record(c.correction_words, tsr_correction_words);
        record[tsr_correction_tile] = static_cast<std::uint32_t>(c.tiles.size());
        record[tsr_correction_byte] = byte_of(payload, streams[i]);
        record[tsr_correction_size] = words_of(streams[i]);
        record[tsr_correction_number] = static_cast<std::uint32_t>(i);
    }
    const std::uint32_t at = c.multipliers;
    c.multipliers += static_cast<std::uint32_t>(shape.texels()) * tables_.planes();
    return at;
}

void BatchBuilder::add_tile(const Entry& entry, std::span<const std::byte> payload,
                            const BlockShape& shape, const TexelPlace& place) {
    Content& c = content_;
    const TreeSize& tree = entry.tree;
    const std::uint32_t values = value_words(entry, static_cast<std::uint64_t>(shape.texels()));
    std::uint32_t* record = append_record(c.tile_words, tsr_tile_words);
    record[tsr_tile_shape] = tables_.shape_id(shape);
    record[tsr_tile_segment] = count_of(c.segment_words.size(), tsr_segment_words);
    record[tsr_tile_segments] = static_cast<std::uint32_t>(entry.parts.segments.size());
    record[tsr_tile_x] = place.x;
    record[tsr_tile_y] = place.y;
    record[tsr_tile_layer] = place.layer;
    record[tsr_tile_origin] = place.u0 | (place.v0 << 16);
    record[tsr_tile_multipliers] = add_corrections(entry, payload, shape);
    record[tsr_tile_blocks] = c.blocks;
    record[tsr_tile_block_room] = tree.blocks;
    record[tsr_tile_copies] =
        tree.copies.empty() ? tsr_none : static_cast<std::uint32_t>(c.copy_words.size());
    record[tsr_tile_values] = values > 0 ? c.values : tsr_none;
    record[tsr_tile_base] = tree.base ? tables_.shape_id(*tree.base) : tsr_none;
    record[tsr_tile_stored] = entry.is_stored ? byte_of(payload, payload) : tsr_none;
    record[tsr_tile_borders] =
        tree.borders.empty() ? tsr_none : static_cast<std::uint32_t>(c.border_words.size());
    add_segments(entry, payload);
    c.border_words.insert(c.border_words.end(), tree.borders.begin(), tree.borders.end());
    c.copy_words.insert(c.copy_words.end(), tree.copies.begin(), tree.copies.end());
    c.values += values;
    c.waves = std::max(c.waves, tree.waves);
    c.most_texels = std::max(c.most_texels, static_cast<std::uint32_t>(shape.texels()));
    c.blocks += tree.blocks;
    c.items += tree.items;
    c.payloads.insert(c.payloads.end(), payload.begin(), payload.end());
    c.payloads.resize((c.payloads.size() + 3) / 4 * 4);
}

// Fills the header, except for the positions of records, and sets the size of the work buffer.
void BatchBuilder::put_header(DecodeBatch& batch) const {
    const Content& c = content_;
    const auto tiles = static_cast<std::uint32_t>(c.tiles.size());
    std::vector<std::uint32_t>& words = batch.words;
    words[tsr_b_tiles] = tiles;
    words[tsr_b_raw_chunks] = batch.raw_chunks;
    words[tsr_b_corrections] = batch.corrections;
    words[tsr_b_payload_bytes] = static_cast<std::uint32_t>(c.payloads.size());
    words[tsr_b_fold_u] = plan_.fold_u;
    words[tsr_b_fold_v] = plan_.fold_v;
    words[tsr_b_folds_u] = plan_.folds_u;
    words[tsr_b_stride_s] = plan_.stride_s;
    words[tsr_b_stride_t] = plan_.stride_t;
    words[tsr_b_items_room] = c.items;
    std::uint32_t at = tsr_w_state + tiles * tsr_state_words;
    const auto place = [&](int field, std::uint32_t count) {
        words[static_cast<std::size_t>(field)] = at;
        at += count;
    };
    place(tsr_b_blocks_at, c.blocks * tsr_block_words);
    place(tsr_b_items_at, c.items * tsr_item_words);
    place(tsr_b_counts_at, count_of(c.segment_words.size(), tsr_segment_words));
    place(tsr_b_multipliers_at, c.multipliers);
    place(tsr_b_raw_at, c.raw * tsr_raw_words);
    place(tsr_b_values_at, c.values);
    batch.work_words = at;
}

DecodeBatch BatchBuilder::finish() {
    Content& c = content_;
    DecodeBatch batch;
    batch.most_segments = c.most_segments;
    batch.raw_chunks = static_cast<std::uint32_t>(c.chunk_words.size());
    batch.corrections = count_of(c.correction_words.size(), tsr_correction_words);
    batch.waves = c.waves;
    batch.predicted = !c.copy_words.empty();
    batch.borders = !c.border_words.empty();
    batch.most_texels = c.most_texels;
    batch.coefficients = c.raw;

    std::vector<std::uint32_t>& words = batch.words;
    words.assign(tsr_batch_words, 0);
    const auto append = [&words](int field, const std::vector<std::uint32_t>& part) {
        words[static_cast<std::size_t>(field)] = static_cast<std::uint32_t>(words.size());
        words.insert(words.end(), part.begin(), part.end());
    };
    append(tsr_b_tile_at, c.tile_words);
    append(tsr_b_segment_at, c.segment_words);
    append(tsr_b_raw_chunk_at, c.chunk_words);
    append(tsr_b_correction_at, c.correction_words);
    append(tsr_b_copies_at, c.copy_words);
    append(tsr_b_borders_at, c.border_words);
    append(tsr_b_payload_at, {});
    words.resize(words.size() + c.payloads.size() / 4);
    if (!c.payloads.empty())
        std::memcpy(words.data() + words[tsr_b_payload_at], c.payloads.data(), c.payloads.size());
    put_header(batch);
    batch.tiles = std::move(c.tiles);
    batch.damaged = std::move(c.damaged);
    content_ = {};
    return batch;
}

} // namespace tessera
