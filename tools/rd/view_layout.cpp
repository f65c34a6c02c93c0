#include "tools/rd/view_layout.h"

#include "tools/rd/bt709.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace tessera {
namespace {

std::byte to_byte(double value) {
    return std::byte(static_cast<std::uint8_t>(std::clamp(std::lround(value), 0l, 255l)));
}

// One sample plane of a view, in 0..255.
struct Plane {
    std::uint32_t width = 0, height = 0;
    std::vector<float> values;
    float& at(std::uint32_t x, std::uint32_t y) { return values[std::size_t{y} * width + x]; }
    float at(std::uint32_t x, std::uint32_t y) const { return values[std::size_t{y} * width + x]; }
};

Plane make_plane(std::uint32_t width, std::uint32_t height) {
    return {width, height, std::vector<float>(std::size_t{width} * height)};
}

// The mean of each 2 x 2 samples; an odd edge counts twice.
Plane halved(const Plane& p) {
    Plane half = make_plane((p.width + 1) / 2, (p.height + 1) / 2);
    for (std::uint32_t y = 0; y < half.height; ++y)
        for (std::uint32_t x = 0; x < half.width; ++x) {
            const std::uint32_t x1 = std::min(2 * x + 1, p.width - 1);
            const std::uint32_t y1 = std::min(2 * y + 1, p.height - 1);
            half.at(x, y) =
                (p.at(2 * x, 2 * y) + p.at(x1, 2 * y) + p.at(2 * x, y1) + p.at(x1, y1)) / 4;
        }
    return half;
}

// Bilinear, the inverse placement of halved().
Plane doubled(const Plane& half, std::uint32_t width, std::uint32_t height) {
    Plane p = make_plane(width, height);
    const auto neighbour = [](std::uint32_t i, std::uint32_t count) {
        const std::uint32_t near = i / 2;
        if (i % 2 == 0)
            return near > 0 ? near - 1 : near;
        return std::min(near + 1, count - 1);
    };
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t x0 = x / 2, x1 = neighbour(x, half.width);
            const std::uint32_t y0 = y / 2, y1 = neighbour(y, half.height);
            p.at(x, y) = (9 * half.at(x0, y0) + 3 * half.at(x1, y0) + 3 * half.at(x0, y1) +
                          half.at(x1, y1)) /
                         16;
        }
    return p;
}

std::byte* write_plane(const Plane& plane, std::byte* to) {
    for (const float value : plane.values)
        *to++ = to_byte(value);
    return to;
}

const std::byte* read_plane(Plane& plane, const std::byte* from) {
    for (float& value : plane.values)
        value = static_cast<float>(std::to_integer<int>(*from++));
    return from;
}

struct Colour {
    float a, b, c; // r, g, b; or y and two differences, 128 for none
};

Colour to_yuv(const Colour& rgb, Chroma chroma) {
    const auto [r, g, b] = rgb;
    if (chroma == Chroma::full)
        return {(r + 2 * g + b) / 4, (2 * g - r - b) / 4 + 128, (r - b) / 2 + 128};
    const auto c = to_bt709(r, g, b);
    return {c.y, c.cb + 128, c.cr + 128};
}

Colour to_rgb(const Colour& yuv, Chroma chroma) {
    const float y = yuv.a, first = yuv.b - 128, second = yuv.c - 128;
    if (chroma == Chroma::full)
        return {y - first + second, y + first, y - first - second};
    const auto c = from_bt709(y, first, second);
    return {c.r, c.g, c.b};
}

void split(const Picture& picture, Chroma chroma, std::array<Plane, 3>& yuv) {
    for (std::size_t i = 0; i < picture.rgb.size() / 3; ++i) {
        const auto c = [&](std::size_t k) {
            return static_cast<float>(std::to_integer<int>(picture.rgb[3 * i + k]));
        };
        const Colour colour = to_yuv({c(0), c(1), c(2)}, chroma);
        yuv[0].values[i] = colour.a;
        yuv[1].values[i] = colour.b;
        yuv[2].values[i] = colour.c;
    }
}

void join(const std::array<Plane, 3>& yuv, Chroma chroma, Picture& picture) {
    for (std::size_t i = 0; i < picture.rgb.size() / 3; ++i) {
        const Colour colour =
            to_rgb({yuv[0].values[i], yuv[1].values[i], yuv[2].values[i]}, chroma);
        picture.rgb[3 * i] = to_byte(colour.a);
        picture.rgb[3 * i + 1] = to_byte(colour.b);
        picture.rgb[3 * i + 2] = to_byte(colour.c);
    }
}

void copy_view(const RdTexture& texture, ViewIndex view, Picture& picture, std::uint32_t x0,
               std::uint32_t y0) {
    for (std::uint32_t v = 0; v < texture.desc.size[axis_v]; ++v)
        for (std::uint32_t u = 0; u < texture.desc.size[axis_u]; ++u)
            std::memcpy(picture.pixel(x0 + u, y0 + v), texture.texel(u, v, view.s, view.t), 3);
}

Picture empty_picture(std::uint32_t width, std::uint32_t height) {
    return {width, height, std::vector<std::byte>(std::size_t{width} * height * 3)};
}

} // namespace

std::vector<ViewIndex> serpentine(const Extent4& size) {
    std::vector<ViewIndex> order;
    for (std::uint32_t t = 0; t < size[axis_t]; ++t)
        for (std::uint32_t i = 0; i < size[axis_s]; ++i)
            order.push_back({t % 2 == 0 ? i : size[axis_s] - 1 - i, t});
    return order;
}

Picture view_picture(const RdTexture& texture, ViewIndex view) {
    Picture picture = empty_picture(texture.desc.size[axis_u], texture.desc.size[axis_v]);
    copy_view(texture, view, picture, 0, 0);
    return picture;
}

Picture mosaic_picture(const RdTexture& texture) {
    const Extent4& n = texture.desc.size;
    Picture picture = empty_picture(n[axis_u] * n[axis_s], n[axis_v] * n[axis_t]);
    for (const ViewIndex view : serpentine(n))
        copy_view(texture, view, picture, view.s * n[axis_u], view.t * n[axis_v]);
    return picture;
}

void store_view(const Picture& picture, std::uint32_t x, std::uint32_t y, const Extent4& n,
                ViewIndex view, std::vector<std::byte>& texels) {
    for (std::uint32_t v = 0; v < n[axis_v]; ++v)
        for (std::uint32_t u = 0; u < n[axis_u]; ++u) {
            const std::uint64_t place = std::uint64_t{v} * n[axis_u] + u;
            const std::uint64_t index = (place * n[axis_t] + view.t) * n[axis_s] + view.s;
            std::memcpy(texels.data() + index * 3, picture.pixel(x + u, y + v), 3);
        }
}

void store_mosaic(const Picture& picture, const Extent4& size, std::vector<std::byte>& texels) {
    for (const ViewIndex view : serpentine(size))
        store_view(picture, view.s * size[axis_u], view.t * size[axis_v], size, view, texels);
}

std::size_t video_bytes(const Extent4& n, Chroma chroma) {
    const std::size_t luma = std::size_t{n[axis_u]} * n[axis_v];
    const std::size_t colour =
        chroma == Chroma::full ? luma : std::size_t{(n[axis_u] + 1) / 2} * ((n[axis_v] + 1) / 2);
    return (luma + 2 * colour) * n[axis_s] * n[axis_t];
}

std::vector<std::byte> video_of(const RdTexture& texture, Chroma chroma) {
    const Extent4& n = texture.desc.size;
    std::vector<std::byte> video(video_bytes(n, chroma));
    const Plane empty = make_plane(n[axis_u], n[axis_v]);
    std::array<Plane, 3> yuv{empty, empty, empty};
    std::byte* to = video.data();
    for (const ViewIndex view : serpentine(n)) {
        split(view_picture(texture, view), chroma, yuv);
        to = write_plane(yuv[0], to);
        for (const Plane& colour : {yuv[1], yuv[2]})
            to = write_plane(chroma == Chroma::full ? colour : halved(colour), to);
    }
    return video;
}

void store_video(std::span<const std::byte> video, Chroma chroma, const Extent4& n,
                 std::vector<std::byte>& texels) {
    const Plane empty = make_plane(n[axis_u], n[axis_v]);
    std::array<Plane, 3> yuv{empty, empty, empty};
    Picture picture = empty_picture(n[axis_u], n[axis_v]);
    const std::byte* from = video.data();
    for (const ViewIndex view : serpentine(n)) {
        from = read_plane(yuv[0], from);
        for (Plane* colour : {&yuv[1], &yuv[2]}) {
            if (chroma == Chroma::full) {
                from = read_plane(*colour, from);
                continue;
            }
            Plane half = make_plane((n[axis_u] + 1) / 2, (n[axis_v] + 1) / 2);
            from = read_plane(half, from);
            *colour = doubled(half, n[axis_u], n[axis_v]);
        }
        join(yuv, chroma, picture);
        store_view(picture, 0, 0, n, view, texels);
    }
}

} // namespace tessera
