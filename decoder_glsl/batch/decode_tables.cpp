#include "decoder_glsl/batch/decode_tables.h"

#include "decoder_glsl/batch/plain_pixels.h"
#include "decoder_glsl/shaders/shader_layout.h"
#include "format/container/file_coding.h"
#include "format/container/syntax.h"
#include "format/samples.h"
#include "format/tile/block_colour.h"
#include "format/tile/border_mode.h"
#include "format/tile/code_tables.h"
#include "format/tile/coding_parameters.h"
#include "format/tile/colour_rotation.h"
#include "format/tile/dct_basis.h"
#include "format/tile/sine_basis.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <string>

namespace tessera {
namespace {

using namespace layout;
using Words = std::vector<std::uint32_t>;

static_assert(tsr_max_blocks == max_leaves && tsr_max_work == max_segment_work &&
              tsr_max_coded == max_coded_length && tsr_max_tile_texels == max_tile_texels &&
              tsr_max_tile_side == max_tile_side && tsr_max_block_side == max_block_side &&
              tsr_max_base_side == max_base_side && tsr_max_angular_side == max_angular_side &&
              tsr_max_frequencies == max_frequencies && tsr_correction_chunk == correction_chunk &&
              tsr_rotations == rotation_count && tsr_base_taps == base_taps &&
              tsr_most_share == most_share && tsr_directions == border_directions &&
              tsr_mode_contexts == mode_contexts && tsr_transform_contexts == transform_contexts &&
              tsr_max_sine_side == max_sine_side);
static_assert(tsr_depth_classes == depth_classes && tsr_size_classes == size_classes &&
              tsr_neighbour_classes == neighbour_classes && tsr_cross_classes == cross_classes &&
              tsr_zero_positions == zero_positions && tsr_magnitude_tables == magnitude_tables &&
              tsr_other_magnitudes == other_magnitudes);
static_assert(tsr_zero_end - tsr_t_zero == zero_parameters);
static_assert(tsr_base_filter_end - tsr_t_base_filter == base_unit * base_taps);
static_assert(tsr_filter_end - tsr_t_filter == max_planes * filter_rings);

std::uint32_t signed_word(std::int32_t value) {
    return static_cast<std::uint32_t>(value);
}

// Writes the starts c[1], c[2], ... of a table in pairs, padded with starts that no slot reaches.
template <int symbols>
void put_symbols(const SymbolTable<symbols>& table, Words& words, int at, int count) {
    for (int i = 0; i < count; ++i) {
        const auto start = [&](int symbol) {
            return symbol < symbols ? std::uint32_t{table.start[static_cast<std::size_t>(symbol)]}
                                    : probability_total;
        };
        words[static_cast<std::size_t>(at + i)] = start(2 * i + 1) | (start(2 * i + 2) << 16);
    }
}

// Writes a list of tables, which must fill the words from `begin` to `end`.
template <int begin, int end, int symbols, std::size_t count>
void put_list(std::span<const SymbolTable<symbols>, count> list, Words& words) {
    constexpr int each = (end - begin) / int{count};
    static_assert(symbols - 1 <= 2 * each && int{count} * each == end - begin);
    int at = begin;
    for (const auto& table : list) {
        put_symbols(table, words, at, each);
        at += each;
    }
}

void put_code_tables(const CodeTables& tables, Words& words) {
    std::ranges::copy(tables.zero, words.begin() + tsr_t_zero);
    put_list<tsr_t_magnitude, tsr_magnitude_end>(std::span(tables.magnitude), words);
    const std::span lengths(tables.first_length);
    put_list<tsr_t_first_length, tsr_first_length_end>(lengths.first<size_classes>(), words);
    put_list<tsr_t_copying_length, tsr_copying_length_end>(lengths.last<size_classes>(), words);
    put_list<tsr_t_other_length, tsr_other_length_end>(std::span(tables.other_length), words);
    put_list<tsr_t_correction, tsr_correction_end>(std::span(tables.correction), words);
    int at = tsr_t_split;
    for (const auto& row : tables.split)
        for (const auto& table : row) {
            put_symbols(table, words, at, tsr_symbol5_words);
            at += tsr_symbol5_words;
        }
    put_list<tsr_t_kind, tsr_kind_end>(std::span(tables.colour), words);
    put_list<tsr_t_share, tsr_share_end>(std::span(tables.share), words);
    put_list<tsr_t_mode, tsr_mode_end>(std::span(tables.mode), words);
    put_list<tsr_t_transform, tsr_transform_end>(std::span(tables.transform), words);
    put_list<tsr_t_prediction, tsr_prediction_end>(std::span(tables.prediction), words);
    put_list<tsr_t_displacement_kind, tsr_displacement_kind_end>(
        std::span(tables.displacement_kind), words);
    put_list<tsr_t_displacement, tsr_displacement_end>(std::span(tables.displacement), words);
    put_list<tsr_t_base, tsr_base_end>(std::span(&tables.base, 1).first<1>(), words);
    put_list<tsr_t_from_base, tsr_from_base_end>(std::span(tables.from_base), words);
    put_list<tsr_t_base_displacement, tsr_base_displacement_end>(
        std::span(&tables.base_displacement, 1).first<1>(), words);
}

void put_transform_tables(Words& words) {
    std::size_t at = tsr_t_rotation;
    for (int i = 0; i < rotation_count; ++i)
        for (const auto& row : rotation_matrix(i))
            for (const std::int32_t x : row)
                words[at++] = signed_word(x);
    at = tsr_t_base_filter;
    for (const auto& taps : base_filter)
        for (const std::int8_t tap : taps)
            words[at++] = signed_word(tap);
    at = tsr_t_direction;
    for (int k = 0; k < border_directions; ++k)
        words[at++] =
            (signed_word(direction_slope(k)) & 0xFFFFu) | signed_word(direction_inverse(k)) << 16;
    at = tsr_t_basis; // and on into tsr_t_wide_basis
    for (int n = 1; n <= max_block_side; ++n)
        for (int i = 0; i < std::min(n, max_frequencies) * n; ++i)
            words[at++] = signed_word(basis(n)[i]);
    at = tsr_t_sine_basis;
    for (int n = 1; n <= max_sine_side; ++n)
        for (int i = 0; i < n * n; ++i)
            words[at++] = signed_word(sine_basis(n)[i]);
}

// The background as a pixel of the texture. A half of -0 decodes to +0.
std::array<std::uint32_t, 2> background_pixel(const FileHeader& header) {
    const TextureDesc& desc = header.desc;
    std::array<std::byte, 8> texel{}, pixel{};
    for (std::size_t c = 0; c < desc.channels; ++c)
        store_sample(texel.data() + c * sample_bytes(desc.type),
                     code_sample(sample_code(header.background[c], desc.type), desc.type),
                     desc.type);
    put_pixels(desc, Box4::whole({1, 1, 1, 1}), texel, 1, pixel);
    std::array<std::uint32_t, 2> words;
    std::memcpy(words.data(), pixel.data(), sizeof words);
    return words;
}

void put_filter(const CodingParameters& coding, SampleType type, Words& words) {
    words[tsr_t_filtered] = coding.filter.is_on();
    std::size_t at = tsr_t_filter;
    for (std::size_t plane = 0; plane < max_planes; ++plane)
        for (const FilterRing& ring : coding.filter.ring[plane == 0 ? 0 : 1])
            words[at++] = filter_slope(ring, coding.step[plane], type) |
                          (signed_word(ring.strength) & 0xFFu) << 16;
}

void put_header(const FileHeader& header, const CodingParameters& coding, Words& words) {
    const auto& desc = header.desc;
    words[tsr_t_sample_type] = static_cast<std::uint32_t>(desc.type);
    words[tsr_t_planes] = desc.channels;
    words[tsr_t_colour] = header.colour == ColourTransform::ycocg_r;
    words[tsr_t_dependent] = coding.dependent;
    words[tsr_t_rotates] = coding.colour_rotation && desc.channels >= 3;
    const auto planes = texel_planes(header.background, desc, header.colour);
    for (std::size_t i = 0; i < 4; ++i)
        words[tsr_t_background + i] = signed_word(planes[i]);
    words[tsr_t_fraction] = static_cast<std::uint32_t>(fraction_bits(desc.type));
    words[tsr_t_predicts] = coding.prediction;
    words[tsr_t_any_plane] = coding.transforms_any_plane;
    words[tsr_t_plane_trees] = coding.plane_trees;
    words[tsr_t_smooth] = coding.smooth_copies;
    words[tsr_t_base_pictures] = coding.base.on;
    words[tsr_t_base_margin] = coding.base.margin;
    put_filter(coding, desc.type, words);
    words[tsr_t_correction_step] = 2u * coding.correction_error + 1;
    for (std::size_t i = 0; i < 4; ++i)
        words[tsr_t_offsets + i] = coding.offsets[i / 2][i % 2];
    const auto pixel = background_pixel(header);
    words[tsr_t_background_texel] = pixel[0];
    words[tsr_t_background_texel + 1] = pixel[1];
}

void append_scan(const ScanOrder& order, Words& words) {
    const ScanNeighbours neighbours = find_neighbours(order);
    for (std::size_t i = 0; i < order.entry.size(); ++i) {
        const auto& k = order.entry[i].k;
        words.push_back(k[0] | (std::uint32_t{k[1]} << 5) | (std::uint32_t{k[2]} << 10) |
                        (std::uint32_t{k[3]} << 15));
        const auto& list = neighbours[i];
        for (std::size_t j = 0; j < list.size(); j += 2)
            words.push_back(list[j] | (std::uint32_t{list[j + 1]} << 16));
        words.push_back(order.context[i].share | (std::uint32_t{order.context[i].position} << 16));
    }
}

std::uint32_t scale_word(const Scale& scale) {
    return static_cast<std::uint32_t>(scale.mantissa) |
           (static_cast<std::uint32_t>(scale.exponent + 128) << 16);
}

void put_scales(const BlockShape& shape, const CodingParameters& coding, SampleType type,
                std::uint32_t* record) {
    for (std::size_t set = 0; set < 5; ++set) {
        const ScaleSet scales = make_scales(set < 4 ? coding.step[set] : coding.rotated_step, shape,
                                            type, coding.dependent);
        static_assert(std::tuple_size_v<ScaleSet> == tsr_scales_of_set);
        for (std::size_t axes = 0; axes < tsr_scales_of_set; ++axes)
            record[tsr_s_scales + set * tsr_scales_of_set + axes] = scale_word(scales[axes]);
    }
}

// Entries of a shape's scan table.
std::size_t coded_frequencies(const BlockShape& shape) {
    std::size_t count = 1;
    for (const int n : shape.n)
        count *= static_cast<std::size_t>(std::min(n, max_frequencies));
    return std::min<std::size_t>(count, max_coded_length);
}

constexpr std::array block_splits = {Split::spatial, Split::angular, Split::u, Split::v};

} // namespace

void DecodeTables::add_subtree(const BlockShape& shape) {
    if (!ids_.try_emplace(shape, static_cast<std::uint32_t>(ids_.size())).second)
        return;
    for (const Split split : block_splits)
        if (can_split(shape, split)) {
            const Children children = children_of(Block{{0, 0, 0, 0}, shape, 0, 0}, split);
            for (int i = 0; i < children.count; ++i)
                add_subtree(children.block[static_cast<std::size_t>(i)].shape);
        }
}

void DecodeTables::add_shapes(const TileGrid& grid) {
    // Along an axis, tiles have at most two extents, which differ by one.
    std::array<std::set<std::uint16_t>, 4> sides;
    for (std::size_t axis = 0; axis < 4; ++axis)
        for (std::uint64_t i = 0; i < grid.count()[axis]; ++i) {
            const std::uint64_t n = grid.count()[axis], size = grid.size()[axis];
            sides[axis].insert(static_cast<std::uint16_t>((i + 1) * size / n - i * size / n));
            if (sides[axis].size() == 2)
                break;
        }
    for (const auto u : sides[0])
        for (const auto v : sides[1])
            for (const auto s : sides[2])
                for (const auto t : sides[3]) {
                    const BlockShape tile{{u, v, s, t}};
                    add_subtree(tile);
                    if (const auto base = base_shape(tile, base_))
                        add_subtree(*base);
                }
}

void DecodeTables::put_children(const BlockShape& shape, std::uint32_t* record) const {
    std::uint32_t* words = record + tsr_s_children;
    for (const Split split : block_splits) {
        std::array<std::uint32_t, 4> ids{0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF};
        if (can_split(shape, split)) {
            const Children children = children_of(Block{{0, 0, 0, 0}, shape, 0, 0}, split);
            for (int i = 0; i < children.count; ++i)
                ids[static_cast<std::size_t>(i)] =
                    ids_.at(children.block[static_cast<std::size_t>(i)].shape);
        }
        *words++ = ids[0] | (ids[1] << 16);
        if (split == Split::spatial || split == Split::angular)
            *words++ = ids[2] | (ids[3] << 16);
    }
}

void DecodeTables::add_shape(const BlockShape& shape, std::uint32_t id, SampleType type) {
    std::uint32_t* record = words_.data() + tsr_t_end + std::size_t{id} * tsr_shape_words;
    const auto& n = shape.n;
    record[tsr_s_sides] = std::uint32_t{n[0]} | (std::uint32_t{n[1]} << 9) |
                          (std::uint32_t{n[2]} << 18) | (std::uint32_t{n[3]} << 24);
    record[tsr_s_size_class] = static_cast<std::uint32_t>(size_class(shape));
    put_scales(shape, coding_, type, record);
    put_children(shape, record);
}

bool DecodeTables::add_scans(std::span<const BlockShape> shapes) {
    for (const BlockShape& shape : shapes) {
        const std::size_t record = tsr_t_end + std::size_t{shape_id(shape)} * tsr_shape_words;
        if (words_[record + tsr_s_scan] != 0)
            continue;
        const ScanOrder order = make_scan_order(shape, coding_.scan_weights);
        const std::size_t at = words_.size();
        if (most_words_ != 0 && order.entry.size() > (most_words_ - at) / tsr_scan_words)
            return false;
        append_scan(order, words_);
        words_[record + tsr_s_scan] = static_cast<std::uint32_t>(at);
        words_[record + tsr_s_coded] = static_cast<std::uint32_t>(order.entry.size());
    }
    return true;
}

void DecodeTables::forget_scans() {
    words_.resize(words_before_scans());
    for (std::size_t at = tsr_t_end; at < words_.size(); at += tsr_shape_words)
        words_[at + tsr_s_scan] = words_[at + tsr_s_coded] = 0;
    ++generation_;
}

std::size_t DecodeTables::words_before_scans() const {
    return tsr_t_end + ids_.size() * tsr_shape_words;
}

// The most words of scan tables that are worth having, and enough for any tile: its blocks have no
// more coefficients than texels.
std::size_t DecodeTables::room_for_scans(const TileGrid& grid) const {
    constexpr std::size_t enough = (std::size_t{2} << 20) / 4;
    std::size_t all = 0;
    for (const auto& [shape, id] : ids_)
        if (!is_too_large(shape))
            all += coded_frequencies(shape) * tsr_scan_words;
    const std::size_t base = base_.on ? max_base_side * max_base_side : 0;
    std::size_t texels = 1;
    for (const std::uint32_t side : grid.tile_extent())
        texels *= side;
    return std::min(all, std::max(enough, (texels + base) * tsr_scan_words));
}

Result<DecodeTables> DecodeTables::make(const ContainerReader& reader, ScanMemory memory) {
    const FileHeader& header = reader.header();
    TESSERA_TRY_ASSIGN(const auto coding, coding_of(reader).with_context(reader.name()));
    DecodeTables tables;
    tables.coding_ = coding;
    tables.planes_ = header.desc.channels;
    tables.has_corrections_ = (header.required_features & feature_corrections) != 0;
    tables.has_stored_tiles_ = (header.required_features & feature_stored) != 0;
    tables.predicts_ = coding.prediction;
    tables.base_ = coding.base;
    tables.filters_ = coding.filter.is_on();
    tables.half_ = traits_of(header.desc.type).is_float;
    tables.add_shapes(reader.grid());
    if (tables.ids_.size() > tsr_max_shapes)
        return Status{ErrorCode::unsupported, reader.name() + ": the tiles split into blocks of " +
                                                  std::to_string(tables.ids_.size()) +
                                                  " shapes, the GPU decoder takes " +
                                                  std::to_string(tsr_max_shapes)};
    Words& words = tables.words_;
    words.resize(tsr_t_end + tables.ids_.size() * tsr_shape_words);
    put_header(header, coding, words);
    tables.code_tables_ =
        std::make_unique<const CodeTables>(coding.parameters, coding.leaves_out_transforms);
    put_code_tables(*tables.code_tables_, words);
    put_transform_tables(words);
    words[tsr_t_shapes] = tsr_t_end;
    for (const auto& [shape, id] : tables.ids_)
        tables.add_shape(shape, id, header.desc.type);
    if (memory == ScanMemory::bounded)
        tables.most_words_ = words.size() + tables.room_for_scans(reader.grid());
    return tables;
}

} // namespace tessera
