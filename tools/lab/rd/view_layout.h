// Converts a texture to the pictures and frames that picture and video codecs take, and back. A
// view is the U x V samples of one (s,t). All functions use 8-bit RGB texels.
#pragma once

#include "tools/lab/rd/rd_texture.h"
#include "tools/picture/picture.h"

#include <vector>

namespace tessera {

struct ViewIndex {
    std::uint32_t s = 0, t = 0;
};

// All views, row by row of t, with every other row backwards, so that consecutive views are
// neighbours in direction.
std::vector<ViewIndex> serpentine(const Extent4& size);

Picture view_picture(const RdTexture& texture, ViewIndex view);
// All views in one picture, view (s,t) at s * U, t * V.
Picture mosaic_picture(const RdTexture& texture);

// Copies a view back from `picture`, where its corner is at (x, y).
void store_view(const Picture& picture, std::uint32_t x, std::uint32_t y, const Extent4& size,
                ViewIndex view, std::vector<std::byte>& texels);
void store_mosaic(const Picture& picture, const Extent4& size, std::vector<std::byte>& texels);

// Precision of the samples of a video. Samples of ten bits take two bytes, low byte first, and hold
// YCgCo without rounding.
enum class VideoSamples { bits8, bits10 };

// Planar 4:4:4 frames of full range, in serpentine order. The planes are Y, Cg and Co: with them
// x265 needs 3 % fewer bits than with BT.709 at equal PSNR.
std::vector<std::byte> video_of(const RdTexture& texture, VideoSamples samples);
// Precondition: `video` has the size that video_of() returns.
void store_video(std::span<const std::byte> video, VideoSamples samples, const Extent4& size,
                 std::vector<std::byte>& texels);

} // namespace tessera
