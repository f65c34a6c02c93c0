#include "tools/contact_sheet.h"

#include "format/half.h"
#include "tools/tiny_font.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tessera {
namespace {

constexpr std::uint32_t gap = 8, label_height = 16, font_scale = 2;
constexpr std::uint32_t max_side = 8192, max_pixels = 1u << 28;

Picture blank(std::uint32_t width, std::uint32_t height, int grey) {
    return {width, height,
            std::vector<std::byte>(std::size_t{width} * height * 3, std::byte(grey))};
}

std::byte* pixel(Picture& p, std::uint32_t x, std::uint32_t y) {
    return p.rgb.data() + (std::size_t{y} * p.width + x) * 3;
}

std::byte display_value(std::uint16_t half) {
    const double x = std::max(0.0, static_cast<double>(half_to_float(half)));
    const double y = std::isfinite(x) ? x / (1 + x) : 1;
    const double code = y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055;
    return std::byte(static_cast<int>(255 * code + 0.5));
}

std::byte channel_value(const TextureDesc& desc, const std::byte* texel, unsigned c) {
    if (desc.channels < 3)
        c = 0;
    if (desc.type == SampleType::unorm8)
        return texel[c];
    std::uint16_t half;
    std::memcpy(&half, texel + 2 * c, 2);
    return display_value(half);
}

// The texels of a box that is a picture in two axes, `across` growing to the right and `up` upwards.
Result<Picture> read_picture(TexelSource& source, const Box4& box, Axis across, Axis up) {
    TESSERA_TRY(source.begin_slab(box));
    std::vector<std::byte> texels(source.desc().box_bytes(box));
    TESSERA_TRY(source.read(box, texels));
    Picture out = blank(box.extent()[across], box.extent()[up], 0);
    const std::byte* texel = texels.data();
    for (std::uint32_t y = out.height; y-- > 0;)
        for (std::uint32_t x = 0; x < out.width; ++x, texel += source.desc().texel_bytes())
            for (unsigned c = 0; c < 3; ++c)
                pixel(out, x, y)[c] = channel_value(source.desc(), texel, c);
    return out;
}

Picture difference_of(const Picture& a, const Picture& b, double amplify) {
    Picture out = a;
    for (std::size_t i = 0; i < out.rgb.size(); ++i) {
        const int d = std::to_integer<int>(a.rgb[i]) - std::to_integer<int>(b.rgb[i]);
        out.rgb[i] = std::byte(static_cast<int>(std::min(255.0, std::abs(d) * amplify + 0.5)));
    }
    return out;
}

Picture enlarge(const Picture& in, std::uint32_t factor) {
    Picture out = blank(in.width * factor, in.height * factor, 0);
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x) {
            const std::size_t from = std::size_t{y / factor} * in.width + x / factor;
            std::memcpy(pixel(out, x, y), in.rgb.data() + from * 3, 3);
        }
    return out;
}

void draw_text(Picture& p, std::uint32_t left, std::uint32_t top, const std::string& text) {
    for (char c : text) {
        const char* rows = tiny_glyph(c);
        for (std::uint32_t y = 0; y < 5 * font_scale; ++y)
            for (std::uint32_t x = 0; x < 3 * font_scale; ++x)
                if ((rows[y / font_scale] - '0') >> (2 - x / font_scale) & 1 &&
                    left + x < p.width && top + y < p.height)
                    std::memset(pixel(p, left + x, top + y), 220, 3);
        left += 4 * font_scale;
    }
}

// A picture with a line of text above it.
struct Panel {
    std::string label;
    Picture picture;
};
using Row = std::vector<Panel>;

Result<Picture> lay_out(const std::vector<Row>& rows) {
    std::uint64_t width = gap, height = gap;
    for (const Row& row : rows) {
        std::uint64_t across = gap, down = 0;
        for (const Panel& panel : row) {
            across += panel.picture.width + gap;
            down = std::max<std::uint64_t>(down, panel.picture.height);
        }
        width = std::max(width, across);
        height += down + label_height + gap;
    }
    if (width * height > max_pixels)
        return Status(ErrorCode::unsupported, "the sheet would be too large");
    Picture sheet =
        blank(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 32);
    std::uint32_t y = gap;
    for (const Row& row : rows) {
        std::uint32_t x = gap, down = 0;
        for (const auto& [label, picture] : row) {
            const std::size_t fits = picture.width / (4 * font_scale);
            draw_text(sheet, x, y, label.substr(0, std::max<std::size_t>(fits, 1)));
            for (std::uint32_t line = 0; line < picture.height; ++line)
                std::memcpy(pixel(sheet, x, y + label_height + line),
                            picture.rgb.data() + std::size_t{line} * picture.width * 3,
                            std::size_t{picture.width} * 3);
            x += picture.width + gap;
            down = std::max(down, picture.height);
        }
        y += down + label_height + gap;
    }
    return sheet;
}

// Index k of n spread over an axis, from the middle of the first n-th to that of the last.
std::uint32_t spread(unsigned k, unsigned n, std::uint32_t extent) {
    return static_cast<std::uint32_t>((2ull * k + 1) * extent / (2ull * n));
}

// The same over the middle half of the axis: grazing views show little.
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
               const std::string& place, Row* rows[3]) {
        auto a = read_picture(a_, box, across, up);
        if (!a.ok())
            return a.status();
        rows[0]->push_back({options_.name_a + " " + place, enlarge(*a, enlarged)});
        if (!b_)
            return {};
        auto b = read_picture(*b_, box, across, up);
        if (!b.ok())
            return b.status();
        rows[1]->push_back({options_.name_b + " " + place, enlarge(*b, enlarged)});
        const std::string times = std::to_string(static_cast<int>(options_.amplify));
        rows[2]->push_back(
            {"difference x " + times, enlarge(difference_of(*a, *b, options_.amplify), enlarged)});
        return {};
    }

    Status add_view(unsigned k) {
        const unsigned n = std::max(1u, options_.views);
        const std::uint32_t s = spread_inside(k, n, size_[axis_s]);
        const std::uint32_t t = spread_inside((k + n / 2) % n, n, size_[axis_t]);
        const Box4 box{{0, 0, s, t}, {size_[axis_u], size_[axis_v], s + 1, t + 1}};
        Row row;
        Row* rows[3] = {&row, &row, &row};
        TESSERA_TRY(add(box, axis_u, axis_v, factor(size_[axis_u], 384),
                        "view s=" + std::to_string(s) + " t=" + std::to_string(t), rows));
        rows_.push_back(std::move(row));
        return {};
    }

    Status add_angular_images() {
        Row row[3];
        Row* rows[3] = {&row[0], &row[1], &row[2]};
        const unsigned n = options_.angular_images;
        for (unsigned k = 0; k < n; ++k) {
            const std::uint32_t u = spread(k, n, size_[axis_u]);
            const std::uint32_t v = spread(1 + k % 3, 5, size_[axis_v]);
            const Box4 box{{u, v, 0, 0}, {u + 1, v + 1, size_[axis_s], size_[axis_t]}};
            TESSERA_TRY(add(box, axis_s, axis_t, factor(size_[axis_s], 128),
                            "u=" + std::to_string(u) + " v=" + std::to_string(v), rows));
        }
        for (Row& r : row)
            if (!r.empty())
                rows_.push_back(std::move(r));
        return {};
    }

    TexelSource& a_;
    TexelSource* b_;
    const SheetOptions& options_;
    Extent4 size_;
    std::vector<Row> rows_;
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

} // namespace tessera
