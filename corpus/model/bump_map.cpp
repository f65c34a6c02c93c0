#include "corpus/model/bump_map.h"

#include <algorithm>

namespace tessera::corpus {
namespace {

// JPEG and dithering colour greys a little; normal maps are blue.
bool holds_normals(const Image& image) {
    std::uint64_t red = 0, blue = 0;
    for (const auto& texel : image.texels) {
        red += texel[0];
        blue += texel[2];
    }
    return blue >= red + 16 * image.texels.size();
}

std::uint8_t coded(double x) {
    return static_cast<std::uint8_t>(std::clamp(127.5 + 127.5 * x, 0.0, 255.0) + 0.5);
}

// The normal map of heights, which repeat at the sides. Rows grow downwards, its y upwards.
Image normals_of(const Image& heights, double scale) {
    const std::uint32_t width = heights.width, height = heights.height;
    Image normals{width, height, {}};
    normals.texels.reserve(heights.texels.size());
    const auto at = [&](std::uint32_t x, std::uint32_t y) {
        return heights.texels[std::size_t{y % height} * width + x % width][0] / 255.0;
    };
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const double rise_x = 0.5 * scale * (at(x + 1, y) - at(x + width - 1, y)),
                         rise_y = 0.5 * scale * (at(x, y + height - 1) - at(x, y + 1));
            const glm::dvec3 n = glm::normalize(glm::dvec3(-rise_x, -rise_y, 1.0));
            normals.texels.push_back({coded(n.x), coded(n.y), coded(n.z), 255});
        }
    return normals;
}

std::string of_materials(std::size_t count) {
    return "map_bump (" + std::to_string(count) + (count == 1 ? " material" : " materials") + ")";
}

} // namespace

void BumpMaps::take(const std::string& picture, double scale, ModelBuilder& builder,
                    ModelMaterial& material) {
    const int image = builder.add_image_or_note(picture);
    if (image < 0)
        return;
    auto& images = builder.model().images;
    if (holds_normals(images[static_cast<std::size_t>(image)])) {
        ++normals_;
        material.normal_texture.image = image;
        material.normal_scale = scale;
        return;
    }
    ++heights_;
    const auto [made, is_new] =
        of_heights_.emplace(std::pair(image, scale), static_cast<int>(images.size()));
    if (is_new)
        images.push_back(normals_of(images[static_cast<std::size_t>(image)], scale));
    material.normal_texture.image = made->second;
}

void BumpMaps::note(std::vector<std::string>& notes) const {
    if (heights_ > 0)
        notes.push_back(of_materials(heights_) +
                        " is grey and is taken for heights, which become normals");
    if (normals_ > 0)
        notes.push_back(of_materials(normals_) + " is blue and is taken for normals");
}

} // namespace tessera::corpus
