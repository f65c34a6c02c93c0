#include "corpus/model_surface/chart_detail.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

// Texels of a layer for each texel of a picture along a side. Texels of both lie askew, so as many
// would blur the picture.
constexpr double oversampling = 1.4;

double doubled(const glm::dvec2& p, const glm::dvec2& q) {
    return std::abs(p.x * q.y - p.y * q.x);
}

// The texels of a picture on a triangle; 0 without a picture.
double picture_texels(const Model& model, const ModelTriangle& triangle, const TextureUse& use) {
    if (use.image < 0)
        return 0.0;
    const Image& image = model.images[static_cast<std::size_t>(use.image)];
    std::array<glm::dvec2, 3> uv;
    for (std::size_t k = 0; k < 3; ++k)
        uv[k] = use.turn * glm::dvec2(model.vertices[triangle.vertices[k]].uv[use.uv]);
    return 0.5 * doubled(uv[1] - uv[0], uv[2] - uv[0]) * image.width * image.height;
}

struct ChartDetail {
    double area = 0;    // in the world
    double density = 0; // of the pictures, in texels per world unit
    double share = 1.0; // FlatChart::share
};

ChartDetail detail_of(const FlatChart& chart, const Model& model) {
    double area = 0, texels = 0;
    for (const std::uint32_t i : chart.triangles) {
        area += 0.5 * glm::length(area_vector(model, model.triangles[i]));
        texels += material_texels(model, model.triangles[i]);
    }
    return {area, area > 0.0 ? std::sqrt(texels / area) : 0.0, chart.share};
}

// The density of a chart where charts have at most `most`.
double density_of(const ChartDetail& chart, double most, double finer) {
    const double viewed = chart.share * most;
    return std::clamp(oversampling / finer * chart.density, least_detail_share * viewed, viewed);
}

} // namespace

double material_texels(const Model& model, const ModelTriangle& triangle) {
    const ModelMaterial& m = model.materials[triangle.material];
    double most = 0;
    for (const TextureUse* use :
         {&m.base_texture, &m.metal_roughness_texture, &m.normal_texture, &m.emission_texture,
          &m.specular_texture, &m.specular_colour_texture})
        most = std::max(most, picture_texels(model, triangle, *use));
    return most;
}

double shrink_to_detail(std::vector<FlatChart>& charts, const Model& model, double texels,
                        double finer) {
    std::vector<ChartDetail> details;
    double viewed = 0; // the area, as large as its density lets it be
    for (const FlatChart& chart : charts) {
        details.push_back(detail_of(chart, model));
        viewed += details.back().area * std::pow(chart.share, 2);
    }
    // At the lower bound no chart has shrunk, at the upper one all have as much as they may.
    double density = std::sqrt(texels / viewed), most = density / least_detail_share;
    for (int step = 0; step < 40; ++step) {
        const double middle = 0.5 * (density + most);
        double sum = 0;
        for (const ChartDetail& chart : details)
            sum += chart.area * std::pow(density_of(chart, middle, finer), 2);
        (sum <= texels ? density : most) = middle;
    }
    for (std::size_t i = 0; i < charts.size(); ++i) {
        const double share = density_of(details[i], density, finer) / density;
        charts[i].shape.scale =
            static_cast<std::uint8_t>(std::clamp(std::lround(share * 256.0), 1l, 256l) - 1);
        charts[i].sides *= (charts[i].shape.scale + 1) / 256.0;
    }
    return density;
}

} // namespace tessera::corpus
