#include "tools/gltf/mean_picture.h"

#include "format/work.h"
#include "tools/support/interrupt.h"
#include "tools/view/view_file.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr std::uint32_t no_triangle = ~0u;

// The first triangle that touches each pixel, like the charts of FORMAT.md 5.2.
std::vector<std::uint32_t> first_triangles(const SurfaceMesh& mesh,
                                           const std::array<std::uint32_t, 2>& size) {
    std::vector<std::uint32_t> first(std::size_t{size[0]} * size[1], no_triangle);
    const glm::dvec2 sides(size[0], size[1]);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        visit_covered_texels({glm::dvec2(mesh.uv[a]) * sides, glm::dvec2(mesh.uv[b]) * sides,
                              glm::dvec2(mesh.uv[c]) * sides},
                             size, [&](std::uint32_t u, std::uint32_t v) {
                                 std::uint32_t& of = first[std::size_t{v} * size[0] + u];
                                 of = std::min(of, i);
                             });
    }
    return first;
}

// The barycentric weights of the second and third corner at the place of a triangle that is near
// (u, v) of the atlas.
glm::dvec2 weights_near(const SurfaceMesh& mesh, std::uint32_t triangle, const glm::dvec2& uv) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const glm::dvec2 origin(mesh.uv[a]), p = uv - origin;
    const glm::dvec2 ab = glm::dvec2(mesh.uv[b]) - origin, ac = glm::dvec2(mesh.uv[c]) - origin;
    const double area = ab.x * ac.y - ab.y * ac.x;
    if (area == 0.0)
        return glm::dvec2(0.0);
    glm::dvec2 weights(std::max(0.0, (p.x * ac.y - p.y * ac.x) / area),
                       std::max(0.0, (ab.x * p.y - ab.y * p.x) / area));
    return weights / std::max(1.0, weights.x + weights.y);
}

// Pixels with a colour, and others that get one.
struct Pixels {
    std::uint32_t width, height;
    std::vector<glm::dvec3> colours;
    std::vector<bool> known;
};

// Gives the unknown pixels the mean colour of the smallest square around them, with sides that are
// powers of two, which has known ones.
void fill_unknown(Pixels& pixels) {
    const auto& [width, height, colours, known] = pixels;
    if (std::find(known.begin(), known.end(), false) == known.end() || width * height == 1)
        return;
    Pixels half{(width + 1) / 2, (height + 1) / 2, {}, {}};
    half.colours.resize(std::size_t{half.width} * half.height, glm::dvec3(0.0));
    half.known.resize(half.colours.size(), false);
    std::vector<int> counts(half.colours.size(), 0);
    const auto above = [&, columns = width](std::size_t i) {
        return std::size_t{i / columns / 2} * half.width + i % columns / 2;
    };
    for (std::size_t i = 0; i < colours.size(); ++i)
        if (known[i]) {
            half.colours[above(i)] += colours[i];
            ++counts[above(i)];
        }
    for (std::size_t i = 0; i < counts.size(); ++i)
        if (counts[i] > 0) {
            half.colours[i] /= counts[i];
            half.known[i] = true;
        }
    fill_unknown(half);
    for (std::size_t i = 0; i < colours.size(); ++i)
        if (!known[i])
            pixels.colours[i] = half.colours[above(i)];
}

} // namespace

Result<MeanPicture> draw_mean_picture(ViewRenderer& renderer, const SurfaceMesh& mesh,
                                      SampleType type, const std::array<std::uint32_t, 2>& size,
                                      const RenderOptions& options) {
    const auto [width, height] = size;
    const std::vector<std::uint32_t> triangles = first_triangles(mesh, size);
    const std::vector<glm::vec3> tangents = mesh_tangents(mesh);
    Pixels pixels{width, height, {}, {}};
    pixels.colours.resize(triangles.size(), glm::dvec3(0.0));
    std::vector<std::byte> alpha(triangles.size(), std::byte{255});
    const glm::dvec2 one(1.0 / width, 1.0 / height);
    const auto draw_row = [&](std::size_t row) -> Status {
        TESSERA_TRY(check_interrupt());
        std::vector<SurfacePoint> points;
        std::vector<std::size_t> places;
        for (std::size_t i = row * width; i < (row + 1) * width; ++i)
            if (triangles[i] != no_triangle) {
                const glm::dvec2 uv =
                    one *
                    (glm::dvec2(static_cast<double>(i % width), static_cast<double>(row)) + 0.5);
                points.push_back(surface_point(mesh, tangents, triangles[i],
                                               weights_near(mesh, triangles[i], uv)));
                places.push_back(i);
            }
        TESSERA_TRY_ASSIGN(const auto means, renderer.mean_values(points, one));
        for (std::size_t i = 0; i < places.size(); ++i) {
            pixels.colours[places[i]] = glm::dvec3(means[i]);
            alpha[places[i]] = std::byte(std::lround(255.0 * std::clamp(means[i].w, 0.0, 1.0)));
        }
        return {};
    };
    std::vector<int> workers(thread_count(options.threads));
    TESSERA_TRY(parallel_for(
        workers, height, [&](int, std::size_t row) { return draw_row(row); },
        [&](std::size_t row) {
            if (options.progress)
                options.progress("picture", static_cast<double>(row), height);
        }));
    for (const std::uint32_t triangle : triangles)
        pixels.known.push_back(triangle != no_triangle);
    fill_unknown(pixels);

    View view{width, height, {}};
    for (const glm::dvec3& colour : pixels.colours)
        for (glm::length_t c = 0; c < 3; ++c)
            view.rgb.push_back(static_cast<float>(colour[c]));
    Picture picture = to_picture(view, type);
    MeanPicture mean{width, height, std::move(picture.rgb)};
    mean.has_alpha =
        std::any_of(alpha.begin(), alpha.end(), [](std::byte a) { return a != std::byte{255}; });
    if (mean.has_alpha) {
        std::vector<std::byte> rgba;
        for (std::size_t i = 0; i < alpha.size(); ++i) {
            rgba.insert(rgba.end(), &mean.pixels[3 * i], &mean.pixels[3 * i] + 3);
            rgba.push_back(alpha[i]);
        }
        mean.pixels = std::move(rgba);
    }
    return mean;
}

} // namespace tessera
