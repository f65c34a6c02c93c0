#include "tools/lab/rd/view_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace tessera {
namespace {

std::byte to_byte(double value) {
    return std::byte(static_cast<std::uint8_t>(std::clamp(std::lround(value), 0l, 255l)));
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

std::size_t bytes_per_sample(VideoSamples samples) {
    return samples == VideoSamples::bits10 ? 2 : 1;
}

float scale_of(VideoSamples samples) {
    return samples == VideoSamples::bits10 ? 4 : 1;
}

void put_sample(std::byte* at, VideoSamples samples, float value) {
    if (samples == VideoSamples::bits8) {
        *at = to_byte(value);
        return;
    }
    const auto code = static_cast<unsigned>(std::clamp(std::lround(value), 0l, 1023l));
    at[0] = static_cast<std::byte>(code & 255);
    at[1] = static_cast<std::byte>(code >> 8);
}

float sample_at(const std::byte* at, VideoSamples samples) {
    const int low = std::to_integer<int>(at[0]);
    return static_cast<float>(
        samples == VideoSamples::bits8 ? low : low + 256 * std::to_integer<int>(at[1]));
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
            const std::uint64_t index = Box4::whole(n).index_of({u, v, view.s, view.t});
            std::memcpy(texels.data() + index * 3, picture.pixel(x + u, y + v), 3);
        }
}

void store_mosaic(const Picture& picture, const Extent4& size, std::vector<std::byte>& texels) {
    for (const ViewIndex view : serpentine(size))
        store_view(picture, view.s * size[axis_u], view.t * size[axis_v], size, view, texels);
}

std::vector<std::byte> video_of(const RdTexture& texture, VideoSamples samples) {
    std::vector<std::byte> video;
    const std::size_t width = bytes_per_sample(samples);
    const float scale = scale_of(samples);
    for (const ViewIndex view : serpentine(texture.desc.size)) {
        const Picture picture = view_picture(texture, view);
        const std::size_t plane = picture.rgb.size() / 3, first = video.size();
        video.resize(first + 3 * plane * width);
        for (std::size_t i = 0; i < plane; ++i) {
            const auto c = [&](std::size_t k) {
                return static_cast<float>(std::to_integer<int>(picture.rgb[3 * i + k]));
            };
            const float r = c(0), g = c(1), b = c(2);
            const std::array ycgco = {(r + 2 * g + b) / 4, (2 * g - r - b) / 4 + 128,
                                      (r - b) / 2 + 128};
            for (std::size_t k = 0; k < 3; ++k)
                put_sample(&video[first + (k * plane + i) * width], samples, ycgco[k] * scale);
        }
    }
    return video;
}

void store_video(std::span<const std::byte> video, VideoSamples samples, const Extent4& n,
                 std::vector<std::byte>& texels) {
    Picture picture = empty_picture(n[axis_u], n[axis_v]);
    const std::size_t plane = picture.rgb.size() / 3, width = bytes_per_sample(samples);
    const float scale = scale_of(samples);
    const std::byte* frame = video.data();
    for (const ViewIndex view : serpentine(n)) {
        for (std::size_t i = 0; i < plane; ++i) {
            const auto c = [&](std::size_t k) {
                return sample_at(frame + (k * plane + i) * width, samples) / scale;
            };
            const float y = c(0), cg = c(1) - 128, co = c(2) - 128;
            picture.rgb[3 * i] = to_byte(y - cg + co);
            picture.rgb[3 * i + 1] = to_byte(y + cg);
            picture.rgb[3 * i + 2] = to_byte(y - cg - co);
        }
        store_view(picture, 0, 0, n, view, texels);
        frame += 3 * plane * width;
    }
}

} // namespace tessera
