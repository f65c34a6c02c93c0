// A texture as codecs of pictures and videos want it. A view is the U x V samples of one (s,t).
// All of these take and give 8-bit RGB.
#pragma once

#include "tools/lab/rd/rd_texture.h"
#include "tools/picture/picture.h"

#include <vector>

namespace tessera {

struct ViewIndex {
    std::uint32_t s = 0, t = 0;
};

// Row by row of t, every other row backwards: neighbours in the order are neighbours in direction.
std::vector<ViewIndex> serpentine(const Extent4& size);

Picture view_picture(const RdTexture& texture, ViewIndex view);
// All views in one picture, view (s,t) at s * U, t * V.
Picture mosaic_picture(const RdTexture& texture);

// Copies a view back: its corner is at (x, y) of `picture`.
void store_view(const Picture& picture, std::uint32_t x, std::uint32_t y, const Extent4& size,
                ViewIndex view, std::vector<std::byte>& texels);
void store_mosaic(const Picture& picture, const Extent4& size, std::vector<std::byte>& texels);

// Planes of a frame after each other, full range, 4:4:4; frames in serpentine order. Y Cg Co, with
// which x265 needs 3 % fewer bits than with BT.709 at equal PSNR.
std::vector<std::byte> video_of(const RdTexture& texture);
// Precondition: `video` is as long as video_of() makes it.
void store_video(std::span<const std::byte> video, const Extent4& size,
                 std::vector<std::byte>& texels);

} // namespace tessera
