#include "corpus/model/model.h"
#include "corpus/photographs/photograph.h"
#include "corpus/picture/picture_readers.h"
#include "format/samples.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tessera::corpus {
namespace {

struct PhotoRows {
    std::uint32_t width = 0, height = 0;
    unsigned channels = 0;
    bool is_light = false;      // linear, and multiplied by alpha
    std::vector<float> samples; // 0..1, or light
};

float photo_sample(std::span<const std::byte> row, std::size_t at, SampleType type) {
    if (type == SampleType::unorm8)
        return static_cast<float>(std::to_integer<int>(row[at])) / 255.0f;
    std::uint16_t half;
    std::memcpy(&half, row.data() + 2 * at, 2);
    const float value = half_to_float(half);
    return std::isfinite(value) ? value : 0.0f;
}

Status wrong_photo_size(const std::string& path, const PictureShape& shape,
                        const PhotoCamera& camera) {
    return {ErrorCode::invalid_file,
            path + ": has " + std::to_string(shape.width) + "x" + std::to_string(shape.height) +
                " pixels, but its camera is for " + std::to_string(camera.width) + "x" +
                std::to_string(camera.height)};
}

// A mask may be a scaled one, as that of the full picture beside a smaller one.
bool fits_camera(const PictureShape& shape, const PhotoCamera& camera, bool is_mask) {
    if (!is_mask)
        return shape.width == camera.width && shape.height == camera.height;
    const auto across = static_cast<double>(shape.width) * camera.height;
    const auto down = static_cast<double>(shape.height) * camera.width;
    return std::abs(across - down) <= std::max(camera.width, camera.height);
}

Status read_photo_rows(const std::string& path, const PosedPhotograph& photograph, bool is_mask,
                       PhotoRows& rows) {
    TESSERA_TRY_ASSIGN(const auto file, open_file(path));
    TESSERA_TRY_ASSIGN(const auto picture, open_picture_file(*file, {.exif = photograph.exif}));
    const PictureShape& shape = picture->shape();
    TESSERA_TRY(check_size(shape.width, shape.height).with_context(path));
    if (!fits_camera(shape, photograph.camera, is_mask))
        return wrong_photo_size(path, shape, photograph.camera);
    rows.width = shape.width;
    rows.height = shape.height;
    rows.channels = shape.channels;
    rows.is_light = shape.is_float;
    const std::size_t in_row = std::size_t{shape.width} * shape.channels;
    rows.samples.resize(in_row * shape.height);
    // Halves keep the eleven bits of deep pictures that matter near white.
    const SampleType type = shape.bits > 8 ? SampleType::half16 : SampleType::unorm8;
    return picture->read_rows(type, 0, shape.height,
                              [&](std::uint32_t y, std::span<const std::byte> row) {
                                  for (std::size_t i = 0; i < in_row; ++i)
                                      rows.samples[y * in_row + i] = photo_sample(row, i, type);
                              });
}

// Straight display values with alpha of one pixel.
std::array<float, 4> display_texel(const PhotoRows& rows, std::size_t pixel) {
    const float* samples = rows.samples.data() + pixel * rows.channels;
    const bool is_grey = rows.channels < 3, has_alpha = rows.channels % 2 == 0;
    std::array<float, 4> texel{};
    texel[3] = has_alpha ? std::clamp(samples[rows.channels - 1], 0.0f, 1.0f) : 1.0f;
    for (std::size_t c = 0; c < 3; ++c) {
        const float value = samples[is_grey ? 0 : c];
        if (!rows.is_light) {
            texel[c] = std::clamp(value, 0.0f, 1.0f);
            continue;
        }
        const float light = has_alpha && texel[3] > 0 ? value / texel[3] : value;
        texel[c] = static_cast<float>(linear_to_srgb(static_cast<double>(light)));
    }
    return texel;
}

// How much a mask says that pixel (x, y) of the photograph counts, by its first channel and alpha.
float mask_weight(const PhotoRows& mask, const PhotoCamera& camera, std::size_t x, std::size_t y) {
    const std::size_t column = x * mask.width / camera.width, row = y * mask.height / camera.height;
    const float* samples = mask.samples.data() + (row * mask.width + column) * mask.channels;
    const float alpha = mask.channels % 2 == 0 ? samples[mask.channels - 1] : 1.0f;
    return std::clamp(samples[0] * alpha, 0.0f, 1.0f);
}

void mix_with(const glm::dvec3& background, std::array<float, 4>& texel) {
    for (std::size_t c = 0; c < 3; ++c) {
        const auto behind = static_cast<float>(background[static_cast<glm::length_t>(c)]);
        texel[c] = texel[3] * texel[c] + (1 - texel[3]) * behind;
    }
    texel[3] = 1;
}

} // namespace

Result<PhotoPixels> read_photograph(const PosedPhotograph& photograph,
                                    const std::optional<glm::dvec3>& background) {
    const PhotoCamera& camera = photograph.camera;
    PhotoRows rows, mask;
    TESSERA_TRY(read_photo_rows(photograph.path, photograph, false, rows));
    if (!photograph.mask_path.empty())
        TESSERA_TRY(read_photo_rows(photograph.mask_path, photograph, true, mask));
    PhotoPixels pixels{camera.width, camera.height, {}};
    pixels.texels.resize(std::size_t{camera.width} * camera.height);
    for (std::size_t i = 0; i < pixels.texels.size(); ++i) {
        auto& texel = pixels.texels[i];
        texel = display_texel(rows, i);
        if (background)
            mix_with(*background, texel);
        if (!mask.samples.empty())
            texel[3] *= mask_weight(mask, camera, i % camera.width, i / camera.width);
    }
    return pixels;
}

} // namespace tessera::corpus
