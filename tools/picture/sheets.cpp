#include "tools/picture/sheets.h"

#include "format/output_file.h"
#include "format/samples.h"
#include "tools/picture/panels.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace tessera {
namespace {

constexpr std::uint32_t max_side = 8192;

std::byte channel_value(const TextureDesc& desc, const std::byte* texel, unsigned c) {
    if (desc.channels < 3)
        c = 0;
    if (!traits_of(desc.type).is_float)
        return texel[c];
    std::uint16_t half;
    std::memcpy(&half, texel + 2 * c, 2);
    return tone_mapped(static_cast<double>(half_to_float(half)));
}

// The texels of a box that extends along two axes, `across` to the right and `up` upwards.
Result<Picture> read_picture(TexelSource& source, const Box4& box, Axis across, Axis up) {
    TESSERA_TRY(source.begin_slab(box));
    std::vector<std::byte> texels(source.desc().box_bytes(box));
    TESSERA_TRY(source.read(box, texels));
    Picture out = blank_picture(box.extent()[across], box.extent()[up], 0);
    const std::byte* texel = texels.data();
    for (std::uint32_t y = out.height; y-- > 0;)
        for (std::uint32_t x = 0; x < out.width; ++x, texel += source.desc().texel_bytes())
            for (unsigned c = 0; c < 3; ++c)
                out.pixel(x, y)[c] = channel_value(source.desc(), texel, c);
    return out;
}

// The middle part of a picture, at most `side` pixels wide and high; all of it for 0.
Picture middle_of(const Picture& picture, std::uint32_t side) {
    const std::uint32_t width = side == 0 ? picture.width : std::min(side, picture.width);
    const std::uint32_t height = side == 0 ? picture.height : std::min(side, picture.height);
    Picture part = blank_picture(width, height, 0);
    for (std::uint32_t y = 0; y < height; ++y)
        std::memcpy(part.pixel(0, y),
                    picture.pixel((picture.width - width) / 2, (picture.height - height) / 2 + y),
                    std::size_t{width} * 3);
    return part;
}

Picture enlarge(const Picture& in, std::uint32_t factor) {
    Picture out = blank_picture(in.width * factor, in.height * factor, 0);
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x) {
            const std::size_t from = std::size_t{y / factor} * in.width + x / factor;
            std::memcpy(out.pixel(x, y), in.rgb.data() + from * 3, 3);
        }
    return out;
}

// The middle of part k of an axis that is divided into n equal parts.
std::uint32_t spread(unsigned k, unsigned n, std::uint32_t extent) {
    return static_cast<std::uint32_t>((2ull * k + 1) * extent / (2ull * n));
}

// The same for the middle half of the axis, as grazing views show little.
std::uint32_t spread_inside(unsigned k, unsigned n, std::uint32_t extent) {
    return static_cast<std::uint32_t>((2ull * n + 2 * (2ull * k + 1)) * extent / (8ull * n));
}

class SheetMaker {
public:
    SheetMaker(TexelSource& a, TexelSource* b, const SheetOptions& options)
        : a_(a), b_(b), options_(options), size_(a.desc().size) {}

    Result<Picture> run() {
        for (unsigned k = 0; k < std::max(1u, options_.views); ++k)
            TESSERA_TRY(add_view(k));
        TESSERA_TRY(add_angular_images());
        return lay_out(rows_);
    }

private:
    std::uint32_t factor(std::uint32_t extent, std::uint32_t wanted) const {
        return std::max(1u, wanted / std::max(1u, extent));
    }

    // Appends A, B and the difference of one box to three rows, or all to one.
    Status add(const Box4& box, Axis across, Axis up, std::uint32_t enlarged,
               const std::string& place, PanelRow* rows[3]) {
        TESSERA_TRY_ASSIGN(auto a, read_picture(a_, box, across, up));
        // Small pictures in columns have no room for both the position and the name.
        const bool is_column = rows[0] != rows[1];
        rows[0]->push_back(
            {is_column ? place : place + " " + options_.name_a, enlarge(a, enlarged)});
        if (!b_)
            return {};
        TESSERA_TRY_ASSIGN(auto b, read_picture(*b_, box, across, up));
        rows[1]->push_back(
            {is_column ? options_.name_b : place + " " + options_.name_b, enlarge(b, enlarged)});
        const std::string times = std::to_string(static_cast<int>(options_.amplify));
        rows[2]->push_back(
            {"difference x " + times, enlarge(difference_of(a, b, options_.amplify), enlarged)});
        return {};
    }

    Status add_view(unsigned k) {
        const unsigned n = std::max(1u, options_.views);
        const std::uint32_t s = spread_inside(k, n, size_[axis_s]);
        const std::uint32_t t = spread_inside((k + n / 2) % n, n, size_[axis_t]);
        const Box4 box{{0, 0, s, t}, {size_[axis_u], size_[axis_v], s + 1, t + 1}};
        PanelRow row;
        PanelRow* rows[3] = {&row, &row, &row};
        TESSERA_TRY(add(box, axis_u, axis_v, factor(size_[axis_u], 384),
                        "view s=" + std::to_string(s) + " t=" + std::to_string(t), rows));
        rows_.push_back(std::move(row));
        return {};
    }

    Status add_angular_images() {
        PanelRow row[3];
        PanelRow* rows[3] = {&row[0], &row[1], &row[2]};
        const unsigned n = options_.angular_images;
        for (unsigned k = 0; k < n; ++k) {
            const std::uint32_t u = spread(k, n, size_[axis_u]);
            const std::uint32_t v = spread(1 + k % 3, 5, size_[axis_v]);
            const Box4 box{{u, v, 0, 0}, {u + 1, v + 1, size_[axis_s], size_[axis_t]}};
            TESSERA_TRY(add(box, axis_s, axis_t, factor(size_[axis_s], 128),
                            "u=" + std::to_string(u) + " v=" + std::to_string(v), rows));
        }
        for (PanelRow& r : row)
            if (!r.empty())
                rows_.push_back(std::move(r));
        return {};
    }

    TexelSource& a_;
    TexelSource* b_;
    const SheetOptions& options_;
    Extent4 size_;
    std::vector<PanelRow> rows_;
};

} // namespace

Result<Picture> make_contact_sheet(TexelSource& a, TexelSource* b, const SheetOptions& options) {
    if (b && a.desc() != b->desc())
        return Status(ErrorCode::difference, "the textures differ in size, type or channels");
    for (std::uint32_t extent : a.desc().size)
        if (extent > max_side)
            return Status(ErrorCode::unsupported,
                          "pictures of " + to_string(a.desc().size) + " are too large for a sheet");
    return SheetMaker(a, b, options).run();
}

Result<Picture> make_picture_grid(std::span<const std::string> paths, const GridOptions& options) {
    if (!options.labels.empty() && options.labels.size() != paths.size())
        return Status(ErrorCode::bad_argument, std::to_string(options.labels.size()) +
                                                   " labels for " + std::to_string(paths.size()) +
                                                   " pictures");
    std::vector<PanelRow> rows;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        TESSERA_TRY_ASSIGN(const auto picture, read_png(paths[i]));
        if (i % options.columns == 0)
            rows.emplace_back();
        rows.back().push_back(
            {options.labels.empty() ? to_path(paths[i]).stem().string() : options.labels[i],
             middle_of(picture, options.middle)});
    }
    return lay_out(rows);
}

} // namespace tessera
