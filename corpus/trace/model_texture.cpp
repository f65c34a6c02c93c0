#include "corpus/trace/model_texture.h"

#include <array>
#include <cmath>

namespace tessera::corpus {
namespace {

std::array<double, 256> make_linear() {
    std::array<double, 256> table{};
    for (std::size_t i = 0; i < 256; ++i) {
        const double x = static_cast<double>(i) / 255.0;
        table[i] = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
    }
    return table;
}

std::size_t wrapped(double index, std::uint32_t count, Wrap wrap) {
    const double n = count;
    if (wrap == Wrap::clamp)
        return static_cast<std::size_t>(std::min(std::max(index, 0.0), n - 1.0));
    const double period = wrap == Wrap::mirror ? 2.0 * n : n;
    double i = index - std::floor(index / period) * period;
    if (i >= n && wrap == Wrap::mirror)
        i = 2.0 * n - 1.0 - i;
    return std::min(static_cast<std::size_t>(i), std::size_t{count} - 1);
}

} // namespace

glm::dvec4 texture_value(const Model& model, const TextureUse& use,
                         const std::array<glm::dvec2, 2>& uv, bool is_colour) {
    if (use.image < 0)
        return glm::dvec4(1.0);
    static const std::array<double, 256> linear = make_linear();
    const Image& image = model.images[static_cast<std::size_t>(use.image)];
    const double x = uv[use.uv].x * image.width - 0.5, y = uv[use.uv].y * image.height - 0.5;
    const double x0 = std::floor(x), y0 = std::floor(y);
    glm::dvec4 sum(0.0);
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const double weight =
                (i == 0 ? 1.0 - (x - x0) : x - x0) * (j == 0 ? 1.0 - (y - y0) : y - y0);
            const auto& texel =
                image.texels[wrapped(y0 + j, image.height, use.wrap_v) * image.width +
                             wrapped(x0 + i, image.width, use.wrap_u)];
            for (std::size_t c = 0; c < 4; ++c)
                sum[static_cast<glm::length_t>(c)] +=
                    weight * (is_colour && c < 3 ? linear[texel[c]] : texel[c] / 255.0);
        }
    return sum;
}

} // namespace tessera::corpus
