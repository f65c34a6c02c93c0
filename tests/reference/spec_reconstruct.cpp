// Predictions, values of blocks, the filter and codes (FORMAT.md part 4).
#include "tests/reference/spec_tile.h"

#include <algorithm>
#include <cmath>

namespace tessera_reference::spec {

// 4.6. Blocks copy only from blocks that are earlier along the angular splits, so the recursion
// ends.
int TileDecoder::depth_of(Block& block) {
    if (block.depth >= 0)
        return block.depth;
    int depth = 0;
    if (block.copies_base) {
        depth = 1;
    } else if (block.copies()) {
        const size_t axis = 2 + *block.copies_along, other = 3 - *block.copies_along;
        for (Block& from : blocks_)
            if (!from.of_base && from.begin[axis] < block.begin[axis] &&
                from.begin[axis] + from.size[axis] >= block.begin[axis] &&
                from.begin[other] < block.begin[other] + block.size[other] &&
                from.begin[other] + from.size[other] > block.begin[other])
                depth = std::max(depth, 1 + depth_of(from));
    }
    require(depth <= 15, "tile: depth of copies");
    return block.depth = depth;
}

// Predicts a texel of a block that copies the base picture.
std::array<int64_t, 4> TileDecoder::predicted_from_base(const Block& block,
                                                        const Vector4& in_tile) const {
    static const int W[8][6] = {{0, 0, 64, 0, 0, 0},    {1, -5, 62, 8, -2, 0},
                                {2, -9, 58, 17, -4, 0}, {2, -9, 49, 28, -7, 1},
                                {2, -9, 39, 39, -9, 2}, {1, -7, 28, 49, -9, 2},
                                {0, -4, 17, 58, -9, 2}, {0, -2, 8, 62, -5, 1}};
    const int x = (in_tile[2] - (size_[2] - 1) / 2) * block.displacement[0];
    const int y = (in_tile[3] - (size_[3] - 1) / 2) * block.displacement[1];
    const int m = *code_.base_margin;
    const auto i = static_cast<int>(in_tile[0] + m + floor_div(x, 8)),
               j = static_cast<int>(in_tile[1] + m + floor_div(y, 8));
    const auto f = static_cast<size_t>(x - 8 * floor_div(x, 8)),
               g = static_cast<size_t>(y - 8 * floor_div(y, 8));
    std::array<int64_t, 4> result{};
    for (size_t p = 0; p < static_cast<size_t>(header_.channels); ++p) {
        const auto R = [&](int b) {
            int64_t sum = 2;
            for (int a = 0; a < 6; ++a) {
                const Vector4 at = {std::clamp(i + a - 2, 0, base_size_[0] - 1),
                                    std::clamp(b, 0, base_size_[1] - 1), 0, 0};
                sum += W[f][a] * base_values_[p][place(at, base_size_)];
            }
            return floor_div(sum, 4);
        };
        int64_t sum = 512;
        for (int b = 0; b < 6; ++b)
            sum += W[g][b] * R(j + b - 2);
        result[p] = floor_div(sum, 1024);
    }
    return result;
}

// Predicts the texel at position `at` of a block that copies from another view.
std::array<int64_t, 4> TileDecoder::predicted(const Block& block, const Vector4& at) const {
    std::array<int64_t, 4> sums{};
    const size_t direction = *block.copies_along;
    const int k = at[2 + direction] + 1;
    const int x = 2 * (block.begin[0] + at[0]) + k * block.displacement[0];
    const int y = 2 * (block.begin[1] + at[1]) + k * block.displacement[1];
    Vector4 from{};
    for (size_t a = 2; a < 4; ++a)
        from[a] = a == 2 + direction ? block.begin[a] - 1 : block.begin[a] + at[a];
    const auto i = static_cast<int>(floor_div(x, 2)), j = static_cast<int>(floor_div(y, 2));
    const int f = x - 2 * i, g = y - 2 * j;
    const auto add = [&](int weight, int a, int b) {
        from[0] = std::clamp(a, 0, size_[0] - 1);
        from[1] = std::clamp(b, 0, size_[1] - 1);
        for (size_t p = 0; p < static_cast<size_t>(header_.channels); ++p)
            sums[p] += weight * plane_values_[p][place(from, size_)];
    };
    if (!code_.smooth_copies) {
        for (int b = 0; b < 2; ++b)
            for (int a = 0; a < 2; ++a)
                add((a == 0 ? 2 - f : f) * (b == 0 ? 2 - g : g), i + a, j + b);
    } else if (f == 0 && g == 0) {
        add(8, i, j);
        for (const int step : {-1, 1}) {
            add(2, i + step, j);
            add(2, i, j + step);
        }
    } else if (f == 1 && g == 1) {
        for (const int b : {j, j + 1})
            for (const int a : {i, i + 1})
                add(4, a, b);
    } else {
        for (const int half : {0, 1})
            for (const int step : {-1, 0, 1})
                add(step == 0 ? 6 : 1, i + (f == 1 ? half : step), j + (f == 1 ? step : half));
    }
    const int parts = code_.smooth_copies ? 16 : 4;
    for (int64_t& sum : sums)
        sum = floor_div(sum + parts / 2, parts);
    return sums;
}

// 4.6, "The border of a block" and "Prediction from the border". Returns the predictions of the
// texels of the block by place().
std::vector<int64_t> TileDecoder::predicted_from_border(const Block& block, size_t plane) const {
    const Vector4& picture = block.of_base ? base_size_ : size_;
    const auto& values = block.of_base ? base_values_[plane] : plane_values_[plane];
    const auto P = [&](int u, int v) { return values[place({u, v, 0, 0}, picture)]; };
    const int u0 = block.begin[0], v0 = block.begin[1];
    const int nu = block.size[0], nv = block.size[1], n = nu + nv;

    std::vector<int64_t> T, L;
    if (v0 > 0)
        for (int i = 0; i < n && u0 + i < picture[0] && height_.at(size_t(u0 + i)) >= v0; ++i)
            T.push_back(P(u0 + i, v0 - 1));
    if (u0 > 0)
        for (int i = 0; i < n && v0 + i < picture[1] && width_.at(size_t(v0 + i)) >= u0; ++i)
            L.push_back(P(u0 - 1, v0 + i));
    const int64_t K = u0 > 0 && v0 > 0 ? P(u0 - 1, v0 - 1) : u0 > 0 ? L[0] : v0 > 0 ? T[0] : 0;
    if (v0 == 0)
        T.assign(1, u0 == 0 ? 0 : L[0]);
    if (u0 == 0)
        L.assign(1, T[0]);
    T.resize(static_cast<size_t>(n), T.back());
    L.resize(static_cast<size_t>(n), L.back());

    std::vector<int64_t> result(static_cast<size_t>(nu * nv));
    const auto fill = [&](const auto& prediction) {
        for_each_place(block.size, [&](const Vector4& at) {
            result[place(at, block.size)] = prediction(at[0], at[1]);
        });
    };
    if (block.mode == 1) {
        int64_t sum = 0, count = 0;
        for (int i = 0; i < nu && v0 > 0; ++i, ++count)
            sum += T[static_cast<size_t>(i)];
        for (int i = 0; i < nv && u0 > 0; ++i, ++count)
            sum += L[static_cast<size_t>(i)];
        fill([&](int, int) { return count == 0 ? 0 : floor_div(sum, count); });
        return result;
    }
    if (block.mode == 2) {
        fill([&](int x, int y) {
            const int64_t a = 64 * (x + 1) / nu, b = 64 * (y + 1) / nv;
            const int64_t across = (64 - a) * L[size_t(y)] + a * T[size_t(nu)];
            const int64_t down = (64 - b) * T[size_t(x)] + b * L[size_t(nv)];
            return floor_div(across + down + 64, 128);
        });
        return result;
    }
    static constexpr int slopes[] = {0, 2, 5, 9, 13, 17, 21, 26, 32};
    static constexpr int inverses[] = {0, 4096, 1638, 910, 630, 482, 390, 315, 256};
    const int k = block.mode - 3;
    const bool exchanged = k < 16;
    const int e = exchanged ? 8 - k : k - 24;
    const int slope = e < 0 ? -slopes[-e] : slopes[e], inverse = inverses[std::abs(e)];
    if (exchanged)
        std::swap(T, L);
    const auto R = [&](int i) {
        if (i == 0)
            return K;
        if (i > 0)
            return T[static_cast<size_t>(std::min(i, n) - 1)];
        return L[static_cast<size_t>(std::min((-i * inverse + 128) / 256, n) - 1)];
    };
    fill([&](int u, int v) {
        const int x = exchanged ? v : u, y = exchanged ? u : v;
        const int g = (y + 1) * slope;
        const int i = x + 1 + static_cast<int>(floor_div(g, 32));
        const int64_t f = g - 32 * floor_div(g, 32);
        return floor_div((32 - f) * R(i) + f * R(i + 1) + 16, 32);
    });
    return result;
}

// Notes that a block of a picture is reconstructed.
void TileDecoder::fill_picture(const Block& block) {
    for (int u = 0; u < block.size[0]; ++u) {
        int& height = height_.at(static_cast<size_t>(block.begin[0] + u));
        require(height == block.begin[1], "this decoder: a column that is not filled from the top");
        height += block.size[1];
    }
    for (int v = 0; v < block.size[1]; ++v) {
        int& width = width_.at(static_cast<size_t>(block.begin[1] + v));
        require(width == block.begin[0], "this decoder: a row that is not filled from the left");
        width += block.size[0];
    }
}

// --------------------------------------------------------------------------- part 4 for one block

void TileDecoder::reconstruct(const Block& block) {
    static const std::vector<Matrix> rotations = make_rotations();
    const size_t planes = static_cast<size_t>(header_.channels);
    const int N = product(block.size);
    const int F = header_.sample_type == 0 ? 14 : 8;
    const Scan& scan = scan_of(block.size);

    std::array<std::vector<int64_t>, 4> values;
    for (size_t p = 0; p < planes; ++p) { // 4.1
        values[p].assign(static_cast<size_t>(N), 0);
        const Step& step = block.rotation >= 0 && p < 3 ? code_.rotated_step : code_.step[p];
        const int longer = static_cast<int>(
            std::count_if(block.size.begin(), block.size.end(), [](int side) { return side > 1; }));
        std::array<Scale, 5> scale;
        const int V = size_[2] * size_[3];
        int k = 0;
        while (block.of_base && !(std::exp2(2 * k + 1) <= V * V && V * V < std::exp2(2 * k + 3)))
            ++k;
        for (int z = 0; z <= longer; ++z) {
            Scale& own = scale[static_cast<size_t>(z)];
            own = make_scale(step, N, z + k % 2, F, code_.dependent);
            own.x -= (k + 1) / 2;
        }
        int plain_z = 0; // of axes without a transform, with sides 2^j
        for (size_t axis = 0; axis < 4; ++axis)
            if (block.transforms[axis] == AxisTransform::none) {
                const int j = std::countr_zero(static_cast<unsigned>(block.size[axis]));
                plain_z += j % 2;
                for (Scale& own : scale)
                    own.x += j / 2;
            }
        for (size_t i = 0; i < block.levels[p].size(); ++i) {
            const int64_t level = block.levels[p][i];
            int z = plain_z;
            for (size_t axis = 0; axis < 4; ++axis)
                z += block.transforms[axis] == AxisTransform::sines ||
                     (block.transforms[axis] == AxisTransform::cosines && scan[i].k[axis] > 0);
            const int offset = code_.offset[p == 0 ? 0 : 1][std::abs(level) == 1 ? 0 : 1];
            values[p][scan[i].where] = dequantise(level, scale[static_cast<size_t>(z)], offset);
        }
    }
    if (block.rotation >= 0 || block.shares) { // 4.4
        const Matrix Q = block.shares ? shares_matrix((*block.shares)[0], (*block.shares)[1])
                                      : rotations[static_cast<size_t>(block.rotation)];
        const bool keeps_dc = block.shares && !block.copies() && block.mode == 0;
        for (size_t i = keeps_dc ? 1 : 0; i < static_cast<size_t>(N); ++i) { // place 0 is DC
            const auto result = recolour(Q, {values[0][i], values[1][i], values[2][i]});
            for (size_t p = 0; p < 3; ++p)
                values[p][i] = result[p];
        }
    }
    for (size_t p = 0; p < planes; ++p) // 4.3
        inverse_transform(values[p], block.size, block.transforms, F - G());

    if (is_in_picture(block) && block.begin == Vector4{}) { // the first block of a picture
        const Vector4& picture = block.of_base ? base_size_ : size_;
        height_.assign(static_cast<size_t>(picture[0]), 0);
        width_.assign(static_cast<size_t>(picture[1]), 0);
    }
    std::array<std::vector<int64_t>, 4> from_border;
    for (size_t p = 0; p < planes && block.mode > 0; ++p)
        from_border[p] = predicted_from_border(block, p);
    for_each_place(block.size, [&](const Vector4& at) {
        Vector4 in_tile{};
        for (size_t a = 0; a < 4; ++a)
            in_tile[a] = block.begin[a] + at[a];
        std::array<int64_t, 4> prediction{};
        if (block.copies_base) // 4.6
            prediction = predicted_from_base(block, in_tile);
        else if (block.copies())
            prediction = predicted(block, at);
        for (size_t p = 0; p < planes; ++p) {
            if (block.only_plane && size_t(*block.only_plane) != p)
                continue;
            if (block.mode > 0)
                prediction[p] = from_border[p][place(at, block.size)];
            int64_t x = values[p][place(at, block.size)] + prediction[p];
            if (predicted_tile_)
                x = std::clamp(x, -value_limit(), value_limit() - 1);
            if (block.of_base)
                base_values_[p][place(in_tile, base_size_)] = x;
            else
                plane_values_[p][place(in_tile, size_)] = x;
        }
    });
    if (is_in_picture(block))
        fill_picture(block);
}

// ---------------------------------------------------------------------------------- 4.7 the filter

void TileDecoder::filter() {
    static const std::array<std::array<Vector4, 4>, 3> rings = {{
        {{{1, 1, 0, 0}, {1, -1, 0, 0}, {-1, 1, 0, 0}, {-1, -1, 0, 0}}},
        {{{2, 2, 0, 0}, {2, -2, 0, 0}, {-2, 2, 0, 0}, {-2, -2, 0, 0}}},
        {{{0, 0, 1, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}, {0, 0, 0, -1}}},
    }};
    for (size_t p = 0; p < static_cast<size_t>(header_.channels); ++p) {
        std::vector<int64_t> before = plane_values_[p];
        for (int64_t& x : before)
            x = std::clamp(x, -value_limit(), value_limit() - 1);
        const Step step = code_.step[p];
        for_each_place(size_, [&](const Vector4& at) {
            const int64_t x = before[place(at, size_)];
            int64_t sum = 128;
            for (size_t i = 0; i < 3; ++i) {
                const auto [A, r] = (*code_.filter)[p == 0 ? 0 : 1][i];
                const int64_t width = r * (2048 + step.m);
                const int64_t B =
                    std::min<int64_t>(65535, (int64_t{std::abs(A)} << (28 - G() - step.e)) / width);
                for (const Vector4& offset : rings[i]) {
                    Vector4 to{};
                    for (size_t a = 0; a < 4; ++a)
                        to[a] = std::clamp(at[a] + offset[a], 0, size_[a] - 1);
                    const int64_t d = before[place(to, size_)] - x;
                    const int64_t D = header_.sample_type == 0 ? 4095 : 65535;
                    const int64_t lost = std::min(std::abs(d), D) * B / 4096;
                    const int64_t share = std::max<int64_t>(0, std::abs(A) - lost);
                    sum += (A < 0 ? -share : share) * d;
                }
            }
            plane_values_[p][place(at, size_)] = x + floor_div(sum, 256);
        });
    }
}

// 4.5
void TileDecoder::make_codes() {
    const size_t planes = static_cast<size_t>(header_.channels);
    std::array<int64_t, 4> background{};
    for (size_t c = 0; c < planes; ++c)
        background[c] = code_of(header_.background[c], header_.sample_type);
    background = to_planes(background, header_.colour);
    for_each_place(size_, [&](const Vector4& at) {
        std::array<int64_t, 4> x{};
        for (size_t p = 0; p < planes; ++p)
            x[p] = floor_div(plane_values_[p][place(at, size_)] + (1 << G()) / 2, 1 << G()) +
                   background[p];
        x = from_planes(x, header_.colour);
        for (size_t c = 0; c < planes; ++c)
            codes_[texel_number(at) * planes + c] = clamp_code(x[c], header_.sample_type);
    });
}

} // namespace tessera_reference::spec
