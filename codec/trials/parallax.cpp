#include "codec/trials/parallax.h"

#include "codec/tile_encoder/base_matches.h"
#include "format/samples.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace tessera {
namespace {

constexpr int cell_side = 8;                        // texels
constexpr int unit_bits = 2, unit = 1 << unit_bits; // of displacements: 1/4 texel per view
constexpr int farthest_match = farthest_base_copy * unit / base_unit;
constexpr int weights = unit * unit; // sum of the weights of bilinear interpolation
// Parallax is assumed if the middle view's neighbours, predicted with the best displacement of each
// cell, keep less than this share of the cells' variation: 0.02 to 0.12 for light fields (0.48 with
// noise of 12 codes), 0.76 to 1.6 for baked textures.
constexpr double most_left = 0.5;

// A view's position relative to the middle one.
struct Neighbour {
    int s, t;
};

// Views beside the middle one along all axes that have several.
std::vector<Neighbour> neighbours_of(const MotionPatch& patch) {
    const auto along = [&](Axis axis) {
        return patch.side(axis) == 1   ? std::vector<int>{0}
               : patch.side(axis) == 2 ? std::vector<int>{1}
                                       : std::vector<int>{-1, 1};
    };
    std::vector<Neighbour> neighbours;
    for (const int s : along(axis_s))
        for (const int t : along(axis_t))
            if (s != 0 || t != 0)
                neighbours.push_back({s, t});
    return neighbours;
}

// Sums over all cells of all patches.
class ParallaxSums {
public:
    explicit ParallaxSums(ViewAlignment alignment) : alignment_(alignment) {}

    void add(const MotionPatch& patch) {
        const std::vector<Neighbour> neighbours = neighbours_of(patch);
        if (neighbours.empty())
            return;
        width_ = patch.side(axis_u);
        height_ = patch.side(axis_v);
        middle_ = view_of(patch, {0, 0});
        views_.clear();
        for (const Neighbour& neighbour : neighbours)
            views_.push_back(view_of(patch, neighbour));
        for (int v = 0; v + cell_side <= height_; v += cell_side)
            for (int u = 0; u + cell_side <= width_; u += cell_side)
                add_cell(u, v);
    }
    // Squared error of the neighbours in the direction that predicts them better.
    double left() const { return std::min(left_[0], left_[1]); }
    bool v_against_u() const { return left_[1] < left_[0]; }
    double variation() const { return variation_; }

private:
    struct View {
        Neighbour position;
        std::vector<std::int32_t> codes; // free_code where masked
    };
    static constexpr std::int32_t free_code = -1;

    View view_of(const MotionPatch& patch, const Neighbour& position) const {
        const int s = (patch.side(axis_s) - 1) / 2 + position.s,
                  t = (patch.side(axis_t) - 1) / 2 + position.t;
        View view{position, {}};
        for (int v = 0; v < height_; ++v)
            for (int u = 0; u < width_; ++u)
                view.codes.push_back(patch.is_free({u, v, s, t}) ? free_code
                                                                 : patch.at({u, v, s, t}));
        return view;
    }
    const std::int32_t* row(const View& view, int v) const {
        return view.codes.data() + std::clamp(v, 0, height_ - 1) * width_;
    }

    // Cells with masked texels are left out.
    void add_cell(int u, int v) {
        double sum = 0, squares = 0;
        const auto add_view = [&](const View& view) {
            for (int b = v; b < v + cell_side; ++b)
                for (int a = u; a < u + cell_side; ++a) {
                    const std::int32_t code = row(view, b)[a];
                    if (code == free_code)
                        return false;
                    sum += code;
                    squares += static_cast<double>(code) * code;
                }
            return true;
        };
        if (!add_view(middle_) || !std::all_of(views_.begin(), views_.end(), add_view))
            return;
        const auto neighbours = static_cast<double>(views_.size());
        const double texels = cell_side * cell_side * (neighbours + 1);
        variation_ += (squares - sum * sum / texels) * neighbours / (neighbours + 1);
        for (const bool against : {false, true}) {
            auto least = std::numeric_limits<std::int64_t>::max();
            for (int d = -farthest_match; d <= farthest_match; ++d) {
                std::int64_t error = 0;
                for (const View& view : views_)
                    if (error < least)
                        error += displaced_error(u, v, view, d, against ? -d : d);
                least = std::min(least, error);
            }
            left_[against] += static_cast<double>(least) / (weights * weights);
        }
    }

    // Squared error, times weights^2, of a cell of a view that copies the middle one, displaced by
    // (along_u, along_v) units a view in addition to the alignment.
    std::int64_t displaced_error(int u, int v, const View& view, int along_u, int along_v) const {
        const int x = (alignment_.u * unit - along_u) * view.position.s,
                  y = (alignment_.v * unit - along_v) * view.position.t;
        const std::int32_t x_part = x & (unit - 1), y_part = y & (unit - 1);
        std::array<std::array<int, 2>, cell_side> columns;
        for (int a = 0; a < cell_side; ++a)
            for (int next : {0, 1})
                columns[a][next] = std::clamp(u + a + (x >> unit_bits) + next, 0, width_ - 1);
        std::int64_t error = 0;
        for (int b = v; b < v + cell_side; ++b) {
            const std::int32_t* const above = row(middle_, b + (y >> unit_bits));
            const std::int32_t* const below = row(middle_, b + (y >> unit_bits) + 1);
            const std::int32_t* const wanted = row(view, b) + u;
            for (int a = 0; a < cell_side; ++a) {
                const auto [left, right] = columns[a];
                const std::int32_t between =
                    (unit - y_part) * ((unit - x_part) * above[left] + x_part * above[right]) +
                    y_part * ((unit - x_part) * below[left] + x_part * below[right]);
                const std::int64_t e = weights * wanted[a] - between;
                error += e * e;
            }
        }
        return error;
    }

    ViewAlignment alignment_;
    int width_ = 0, height_ = 0; // of the patch
    View middle_{};
    std::vector<View> views_;      // its neighbours
    std::array<double, 2> left_{}; // v with u, v against u
    double variation_ = 0;
};

} // namespace

MotionPatch::MotionPatch(const Box4& box, const TileTexels& tile, const TextureDesc& desc)
    : extent_(box.extent()), matters_(tile.matters) {
    const std::span<const std::byte> texels = tile.texels;
    const std::size_t green = desc.channels >= 3 ? 1 : 0, bytes = sample_bytes(desc.type);
    for (std::size_t at = green * bytes; at < texels.size(); at += desc.texel_bytes())
        codes_.push_back(sample_code(load_sample(texels.data() + at, desc.type), desc.type));
}

BasePictures parallax_in(std::span<const MotionPatch> patches, ViewAlignment alignment) {
    ParallaxSums sums(alignment);
    for (const MotionPatch& patch : patches)
        sums.add(patch);
    if (sums.left() >= most_left * sums.variation())
        return {};
    return {.on = true, .v_against_u = sums.v_against_u()};
}

} // namespace tessera
