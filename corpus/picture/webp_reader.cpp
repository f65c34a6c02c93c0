#include "corpus/picture/picture_readers.h"

#include <webp/decode.h>

namespace tessera::corpus {

Result<Image> read_webp(std::span<const std::byte> file) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(file.data());
    WebPBitstreamFeatures features;
    const VP8StatusCode header = WebPGetFeatures(bytes, file.size(), &features);
    if (header == VP8_STATUS_NOT_ENOUGH_DATA)
        return damaged("WebP: it ends too early");
    if (header != VP8_STATUS_OK)
        return damaged("WebP: its header is invalid");
    if (features.has_animation)
        return not_supported("an animated WebP");
    const auto width = static_cast<std::uint32_t>(features.width);
    const auto height = static_cast<std::uint32_t>(features.height);
    TESSERA_TRY(check_size(width, height));
    Image image{width, height, {}};
    image.texels.resize(std::size_t{width} * height);
    if (!WebPDecodeRGBAInto(bytes, file.size(), image.texels.data()->data(),
                            image.texels.size() * 4, static_cast<int>(width * 4)))
        return damaged("WebP: its pixels are damaged, or it ends too early");
    return image;
}

} // namespace tessera::corpus
