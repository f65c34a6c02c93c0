// Mosaics: one picture with the angular image of every place, x = u * S + s, y = v * T + t, as
// lenslet cameras and our EXR files have them.
#pragma once

#include "format/texture.h"
#include "tools/support/view_order.h"

#include <string>

namespace tessera {

// Of the texture in a mosaic of width x height pixels with angular images of `angular`. Errors:
// bad_argument, where the sides are no multiples of them.
inline Result<Extent4> mosaic_size(const ViewGrid& angular, std::uint64_t width,
                                   std::uint64_t height) {
    if (width % angular.s != 0 || height % angular.t != 0 || width / angular.s > max_extent ||
        height / angular.t > max_extent)
        return Status(ErrorCode::bad_argument,
                      "its " + std::to_string(width) + "x" + std::to_string(height) +
                          " pixels are no mosaic of angular images of " + to_string(angular));
    return Extent4{static_cast<std::uint32_t>(width / angular.s),
                   static_cast<std::uint32_t>(height / angular.t), angular.s, angular.t};
}

// Errors: invalid_file, where a mosaic of that size has other sides.
inline Status check_mosaic(const Extent4& size, std::uint64_t width, std::uint64_t height) {
    const std::uint64_t want_width = std::uint64_t{size[axis_u]} * size[axis_s];
    const std::uint64_t want_height = std::uint64_t{size[axis_v]} * size[axis_t];
    if (width == want_width && height == want_height)
        return {};
    return {ErrorCode::invalid_file, "a mosaic of " + to_string(size) + " has " +
                                         std::to_string(want_width) + "x" +
                                         std::to_string(want_height) + " pixels, the picture " +
                                         std::to_string(width) + "x" + std::to_string(height)};
}

} // namespace tessera
