#include "corpus/surface/rect_packing.h"

#include <algorithm>
#include <cmath>
#include <stb/stb_rect_pack.h>

namespace tessera::corpus {
namespace {

constexpr int most_side = 1 << 15;

// Into a strip of this width, as low as the skyline heuristic can; the height, or 0 where it cannot.
std::uint32_t pack_into(std::vector<stbrp_rect>& rectangles, std::uint32_t width) {
    std::vector<stbrp_node> nodes(width); // as many as it is wide: places are exact then
    stbrp_context context;
    stbrp_init_target(&context, static_cast<int>(width), most_side, nodes.data(),
                      static_cast<int>(width));
    if (stbrp_pack_rects(&context, rectangles.data(), static_cast<int>(rectangles.size())) == 0)
        return 0;
    std::uint32_t height = 0;
    for (const stbrp_rect& r : rectangles)
        height = std::max(height, static_cast<std::uint32_t>(r.y + r.h));
    return height;
}

} // namespace

Result<RectPacking> pack_rectangles(std::span<const std::array<std::uint32_t, 2>> sides) {
    std::vector<stbrp_rect> rectangles;
    std::uint32_t widest = 1;
    double area = 0;
    for (const auto& [w, h] : sides) {
        if (w > most_side || h > most_side)
            return Status(ErrorCode::unsupported, "a rectangle is too large for the atlas");
        rectangles.push_back({static_cast<int>(rectangles.size()), static_cast<int>(w),
                              static_cast<int>(h), 0, 0, 0});
        widest = std::max(widest, w);
        area += static_cast<double>(w) * h;
    }
    RectPacking best;
    std::uint64_t least = UINT64_MAX;
    const auto square = static_cast<std::uint32_t>(std::ceil(std::sqrt(area)));
    const std::uint32_t last = std::min<std::uint32_t>(std::max(widest, 2 * square), most_side);
    for (std::uint32_t width = widest; width <= last; ++width) {
        const std::uint32_t height = pack_into(rectangles, width);
        const std::uint64_t size = std::uint64_t{width} * height;
        if (height == 0 || size >= least)
            continue;
        least = size;
        best.size = {width, height};
        best.places.resize(sides.size());
        for (const stbrp_rect& r : rectangles)
            best.places[static_cast<std::size_t>(r.id)] = {static_cast<std::uint32_t>(r.x),
                                                           static_cast<std::uint32_t>(r.y)};
    }
    if (best.places.size() != sides.size())
        return Status(ErrorCode::unsupported, "the charts do not fit an atlas");
    return best;
}

} // namespace tessera::corpus
