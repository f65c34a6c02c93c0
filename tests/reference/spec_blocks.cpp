// Blocks and their levels (FORMAT.md 3.4).
#include "tests/reference/spec_tile.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace tessera_reference::spec {

namespace {

Scan make_scan(const Vector4& n, const std::array<int, 4>& weight) {
    Scan scan;
    for (int t = 0; t < coded_frequencies(n[3]); ++t)
        for (int s = 0; s < coded_frequencies(n[2]); ++s)
            for (int v = 0; v < coded_frequencies(n[1]); ++v)
                for (int u = 0; u < coded_frequencies(n[0]); ++u) {
                    const Vector4 k{u, v, s, t};
                    int cost = 0;
                    for (size_t a = 0; a < 4; ++a)
                        cost += weight[a] * k[a] * 8 / n[a];
                    scan.push_back({k, cost, 0, place(k, n)});
                }
    // The loops visit coefficients in ascending order of `where`.
    std::stable_sort(scan.begin(), scan.end(),
                     [](const Coefficient& a, const Coefficient& b) { return a.cost < b.cost; });
    scan.resize(std::min<size_t>(scan.size(), 4096));
    for (size_t i = 0; i < scan.size(); ++i)
        scan[i].position = i == 0 ? 0 : std::min(1 + scan[i].cost / 96, 5);
    return scan;
}

} // namespace

int64_t read_magnitude(Stream& stream, int q) {
    if (q < 4)
        return q + 1;
    const int g = q - 3;
    int64_t h = 0;
    if (g > 16)
        h = stream.raw(g - 16);
    const int64_t l = stream.raw(std::min(g, 16));
    return (int64_t{1} << g) + h * 65536 + l + 3;
}

const Scan& TileDecoder::scan_of(const Vector4& n) {
    const auto found = scans_.find(n);
    return found != scans_.end() ? found->second : (scans_[n] = make_scan(n, code_.scan_weight));
}

// 3.4. Reads the tree of the tile's base picture if the tile has one.
void TileDecoder::read_base_tree(Stream& stream) {
    if (!code_.base_margin || size_[2] * size_[3] < 4 || size_[0] > 64 || size_[1] > 64)
        return;
    base_size_ = {size_[0] + 2 * *code_.base_margin, size_[1] + 2 * *code_.base_margin, 1, 1};
    has_base_ = stream.symbol(code_.base) == 1;
    if (has_base_) {
        begin_picture(base_size_);
        read_split_tree(stream, {0, 0, 0, 0}, base_size_, 0, 5, true);
    }
}

// 3.4, "Trees of planes"
void TileDecoder::read_tile_trees(Stream& stream) {
    const bool is_picture = size_[2] * size_[3] == 1;
    const bool has_two = code_.has_plane_trees && is_picture && stream.raw(1) == 1;
    for (int tree = 0; tree < (has_two ? 2 : 1); ++tree) {
        if (has_two)
            plane_of_tree_ = tree;
        begin_picture(size_);
        read_split_tree(stream, {0, 0, 0, 0}, size_, 0, 0);
    }
    plane_of_tree_.reset();
}

void TileDecoder::begin_picture(const Vector4& size) {
    picture_size_ = size;
    mode_at_.assign(static_cast<size_t>(product(size)), 0);
}

// 3.4, "Pictures"
void TileDecoder::read_mode(Stream& stream, Block& block) {
    const auto mode_at = [&](int u, int v) {
        return u < 0 || v < 0 ? 0 : mode_at_[place({u, v, 0, 0}, picture_size_)];
    };
    const auto kind = [](int mode) { return mode == 0 ? 0 : mode <= 2 ? 1 : 2; };
    const int A = mode_at(block.begin[0], block.begin[1] - 1);
    const int L = mode_at(block.begin[0] - 1, block.begin[1]);
    const int symbol = stream.symbol(code_.mode[3 * kind(A) + kind(L)]);
    std::vector<int> likely;
    for (const int mode : {L, A, 27, 11})
        if (mode >= 3 && std::count(likely.begin(), likely.end(), mode) == 0)
            likely.push_back(mode);
    if (symbol <= 2)
        block.mode = symbol;
    else if (symbol <= 4)
        block.mode = likely[static_cast<size_t>(symbol - 3)];
    else
        block.mode = 3 + static_cast<int>(stream.raw(5));
    for_each_place(block.size, [&](const Vector4& at) {
        mode_at_[place({block.begin[0] + at[0], block.begin[1] + at[1], 0, 0}, picture_size_)] =
            block.mode;
    });
}

void TileDecoder::read_split_tree(Stream& stream, const Vector4& begin, const Vector4& size, int a,
                                  int b, bool of_base) {
    ++nodes_;
    const bool is_cut = size[0] > 64 || size[1] > 64;
    const int split = is_cut ? 1 : stream.symbol(code_.split[std::min(a, 5)][std::min(b, 5)]);
    if (split == 0) {
        require(blocks_.size() < 4096, "tile: too many blocks");
        Block& block = blocks_.emplace_back();
        block.begin = begin;
        block.size = size;
        block.of_base = of_base;
        block.only_plane = plane_of_tree_;
        if (code_.has_predictions && is_in_picture(block))
            read_mode(stream, block);
        else if (code_.has_predictions)
            read_prediction(stream, block);
        return;
    }
    static constexpr bool divides[5][4] = {
        {}, {true, true}, {false, false, true, true}, {true}, {false, true}};
    const auto& divided = divides[split]; // the axes that this split divides
    bool divides_a_side = false;
    for (size_t axis = 0; axis < 4; ++axis)
        divides_a_side = divides_a_side || (divided[axis] && size[axis] > 1);
    require(divides_a_side, "tile: a split must divide a side");
    // The bits of `part` say which half of each axis the child takes; u has the lowest bit. An axis
    // that is not divided, and one of side 1, has no half 1.
    for (int part = 0; part < 16; ++part) {
        Vector4 child_begin = begin, child_size = size;
        for (size_t axis = 0; axis < 4; ++axis) {
            const bool second = part >> axis & 1;
            const int half = divided[axis] ? (size[axis] + 1) / 2 : size[axis];
            child_begin[axis] += second ? half : 0;
            child_size[axis] = second ? size[axis] - half : half;
        }
        if (product(child_size) > 0)
            read_split_tree(stream, child_begin, child_size, a + (split != 2), b + (split == 2),
                            of_base);
    }
}

int TileDecoder::read_difference(Stream& stream, const Table& table) {
    const int k = stream.symbol(table);
    if (k == 0)
        return 0;
    const int m = static_cast<int>(stream.raw(k - 1));
    const int magnitude = (1 << (k - 1)) + m;
    return stream.raw(1) ? -magnitude : magnitude;
}

void TileDecoder::read_prediction(Stream& stream, Block& block) {
    if (has_base_) {
        block.copies_base = stream.symbol(code_.from_base[last_copied_base_]) == 1;
        last_copied_base_ = block.copies_base;
        if (block.copies_base) {
            last_base_displacement_ += read_difference(stream, code_.base_displacement);
            require(std::abs(last_base_displacement_) <= 127, "tile: displacement");
            const int d = last_base_displacement_;
            block.displacement = {d, code_.v_against_u ? -d : d};
            return;
        }
    }
    const bool s_before = block.begin[2] > 0, t_before = block.begin[3] > 0;
    if (!s_before && !t_before)
        return;
    const int w = !t_before ? 0 : !s_before ? 1 : 2;
    const int symbol = stream.symbol(code_.prediction[2 * w + last_block_copied_]);
    require(w == 2 || symbol <= 1, "tile: prediction symbol");
    last_block_copied_ = symbol != 0;
    if (symbol == 0)
        return;
    const size_t direction = w == 1 || symbol == 2 ? 1 : 0;
    auto& known = displacement_[direction];
    const int kind = stream.symbol(code_.displacement_kind[direction]);
    std::array<int, 2> d = known[kind == 1 ? 1 : 0];
    if (kind == 2)
        for (size_t component = 0; component < 2; ++component) {
            d[component] +=
                read_difference(stream, code_.displacement[component == direction ? 0 : 1]);
            require(std::abs(d[component]) <= 127, "tile: displacement");
        }
    if (d != known[0]) {
        known[1] = known[0];
        known[0] = d;
    }
    block.copies_along = direction;
    block.displacement = d;
}

// What the colour symbols of a segment depend on.
struct TileDecoder::ColourMemory {
    int r = 0;                    // 0 plain, 1 rotated, 2 predicted from luma
    bool last_had_shares = false; // whether the last block that was not plain had shares
    int rotation = 0;             // of the last rotated block
    std::array<int, 2> shares{};  // of the last block that was predicted from luma
};

void TileDecoder::read_colour(Stream& stream, Block& block, ColourMemory& memory) {
    const int symbol = stream.symbol(code_.colour[memory.r]);
    if (symbol == 0) {
        memory.r = 0;
        return;
    }
    if (symbol == 2) {
        memory.rotation = static_cast<int>(stream.raw(6));
        require(memory.rotation < 49, "tile: rotation");
        memory.last_had_shares = false;
    } else if (symbol == 3) {
        for (size_t i = 0; i < 2; ++i) {
            memory.shares[i] += read_difference(stream, code_.share[i]);
            require(std::abs(memory.shares[i]) <= 64, "tile: share");
        }
        require(memory.shares[0] != 0 || memory.shares[1] != 0, "tile: shares 0, 0");
        memory.last_had_shares = true;
    }
    if (memory.last_had_shares)
        block.shares = memory.shares;
    else
        block.rotation = memory.rotation;
    memory.r = memory.last_had_shares ? 2 : 1;
}

void TileDecoder::read_transform(Stream& stream, Block& block) {
    const int larger = std::max(block.size[0], block.size[1]);
    if (!is_in_picture(block) || block.mode == 0 || larger > 32)
        return;
    const size_t c = larger <= 4 ? 0 : larger <= 8 ? 1 : larger <= 16 ? 2 : 3;
    const size_t k = block.mode <= 2 ? 0 : block.mode <= 18 ? 1 : 2;
    const int symbol = stream.symbol(code_.transform[3 * c + k]);
    const bool sines[2] = {symbol == 1 || symbol == 2, symbol == 1 || symbol == 3};
    const bool none[2] = {symbol == 4 || symbol == 5, symbol == 4 || symbol == 6};
    for (size_t axis = 0; axis < 2; ++axis) {
        const auto side = static_cast<unsigned>(block.size[axis]);
        if (sines[axis] && side > 1)
            block.transforms[axis] = AxisTransform::sines;
        else if (none[axis] && side > 1 && std::has_single_bit(side))
            block.transforms[axis] = AxisTransform::none;
    }
}

void TileDecoder::read_segment(Stream& stream, size_t begin, size_t end, int64_t work) {
    ColourMemory colours;
    for (size_t number = begin; number < end; ++number) {
        Block& block = blocks_[number];
        const int texels = product(block.size);
        int first_token = 0;
        bool has_length = false; // of a plane before
        for (int plane = 0; plane < header_.channels; ++plane) {
            if (block.only_plane.value_or(plane) != plane)
                continue;
            const bool is_first = plane == 0 || block.only_plane;
            // 1. The length token.
            int k = 0;
            if (is_first || code_.has_plane_trees) {
                const int b = std::bit_width(static_cast<uint32_t>(texels));
                k = stream.symbol(
                    code_.first_length[std::min(b / 2, 8) + (block.copies() ? 9 : 0)]);
                first_token = k;
            } else {
                k = stream.symbol(code_.other_length[first_token]);
            }
            int length = 0;
            if (k > 0) {
                const int e = std::min(k - 1, 2);
                const int m = static_cast<int>(stream.raw(e));
                length = std::min((1 << (k - 1)) + (m << (k - 1 - e)),
                                  static_cast<int>(scan_of(block.size).size()));
            }
            work += 1 + length;
            require(work <= 16000, "tile: the work of a segment");

            // 2. The colour.
            if (plane == 0 && length > 0 && code_.has_colour_symbols && header_.channels >= 3)
                read_colour(stream, block, colours);

            // 3. The transform.
            if (length > 0 && (code_.transforms_any_plane ? !has_length : is_first))
                read_transform(stream, block);
            has_length = has_length || length > 0;

            // 4. The coefficients.
            read_plane(stream, block, plane, length);
        }
    }
}

namespace {

int amplitude_code(int64_t x) {
    if (x < 2)
        return static_cast<int>(x);
    const int n = std::bit_width(static_cast<uint64_t>(x));
    return std::min(2 * (n - 1) + static_cast<int>(x >> (n - 2) & 1), 15);
}

int amplitude_value(int code) {
    static constexpr int values[] = {0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192};
    return values[code];
}

} // namespace

void TileDecoder::read_plane(Stream& stream, Block& block, int plane, int length) {
    // The steps lead from a neighbour to the coefficient.
    struct Neighbour {
        Vector4 step;
        int weight;
    };
    static constexpr Neighbour neighbour_list[] = {
        {{1, 0, 0, 0}, 2},  {{0, 1, 0, 0}, 2},  {{0, 0, 1, 0}, 2},  {{0, 0, 0, 1}, 2},
        {{1, 0, 1, 0}, 1},  {{1, 0, -1, 0}, 1}, {{-1, 0, 1, 0}, 1}, {{0, 1, 0, 1}, 1},
        {{0, 1, 0, -1}, 1}, {{0, -1, 0, 1}, 1}, {{1, 1, 0, 0}, 1},  {{0, 0, 1, 1}, 1}};
    static constexpr int after_even[] = {0, 5, 1, 6, 2, 4, 3, 7};
    static constexpr int after_odd[] = {2, 7, 3, 4, 0, 6, 1, 5};

    const Scan& scan = scan_of(block.size);
    std::vector<int>& amplitude = amplitude_[static_cast<size_t>(plane)];
    amplitude.assign(static_cast<size_t>(product(block.size)), -1);
    std::vector<int32_t>& levels = block.levels[static_cast<size_t>(plane)];
    const bool as_first = plane == 0 || code_.has_plane_trees;
    int state = 0;
    for (size_t i = 0; i < static_cast<size_t>(length); ++i) {
        const Coefficient& coefficient = scan[i];
        const int B = block.copies() ? 1 : 0;
        const int Q = code_.dependent ? state % 2 : 0;
        int w = 0, S = 0;
        for (const Neighbour& neighbour : neighbour_list) {
            Vector4 from{};
            bool inside = true;
            for (size_t a = 0; a < 4; ++a) {
                from[a] = coefficient.k[a] - neighbour.step[a];
                inside = inside && from[a] >= 0 && from[a] < block.size[a];
            }
            if (inside && amplitude[place(from, block.size)] >= 0) {
                w += neighbour.weight;
                S += neighbour.weight * amplitude_value(amplitude[place(from, block.size)]);
            }
        }
        const int neighbours = i == 0 ? std::min(static_cast<int>(std::bit_width(
                                                     static_cast<uint32_t>(product(block.size)))) /
                                                     2,
                                                 8)
                                      : amplitude_code(S * (4096 / w) / 512);
        int cross = 0;
        for (size_t p = 0; p < static_cast<size_t>(plane) && !as_first; ++p)
            cross = amplitude_code(amplitude_value(cross) +
                                   amplitude_value(std::max(amplitude_[p][coefficient.where], 0)));
        const int K = std::min((cross + 1) / 2, 5);
        const int row = as_first ? 0 : 1 + K;

        int64_t magnitude = 0, level = 0;
        if (stream.bit(code_.zero[B][Q][row][coefficient.position][neighbours])) {
            int m = i == 0 ? 16 + neighbours : neighbours;
            if (!as_first)
                m = i == 0 ? 57 + neighbours : 25 + 4 * (neighbours / 2) + std::max(K - 2, 0);
            const int q = stream.symbol(code_.magnitude[B][Q][m]);
            magnitude = read_magnitude(stream, q);
            level = code_.dependent ? 2 * magnitude - Q : magnitude;
            require(level <= (1 << 20) - 1, "tile: a level's magnitude");
        }
        amplitude[coefficient.where] = amplitude_code(code_.dependent ? level : 2 * level);
        if (magnitude > 0 && stream.raw(1))
            level = -level;
        levels.push_back(static_cast<int32_t>(level));
        state = magnitude % 2 == 0 ? after_even[state] : after_odd[state];
    }
}

} // namespace tessera_reference::spec
