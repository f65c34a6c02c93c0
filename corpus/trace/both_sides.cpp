#include "corpus/trace/path_random.h"
#include "corpus/trace/ray_model.h"

namespace tessera::corpus {
namespace {

constexpr unsigned ways = 64;

ModelTriangle turned(const ModelTriangle& triangle) {
    return {{triangle.vertices[0], triangle.vertices[2], triangle.vertices[1]}, triangle.material};
}

// Whether a ray from the triangle's back, somewhere on it, leads out of the model.
bool is_open(const RayModel& rays, std::uint32_t triangle) {
    for (unsigned i = 0; i < ways; ++i) {
        PathRandom random(0, i);
        glm::dvec2 b = random.next2();
        if (b.x + b.y > 1.0)
            b = 1.0 - b;
        const LitPoint p = rays.point({triangle, b});
        const glm::dvec3 d = sample_cosine(-p.face, random.next2());
        if (!rays.is_walled(p.position - 1e-3 * p.face, d))
            return true;
    }
    return false;
}

} // namespace

Result<Model> with_both_sides(Model model) {
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t i = 0; i < model.triangles.size(); ++i)
        if (model.materials[model.triangles[i].material].double_sided)
            candidates.push_back(i);
    if (candidates.empty())
        return model;
    TESSERA_TRY_ASSIGN(const auto rays, RayModel::make(model));
    for (const std::uint32_t i : candidates) {
        if (!is_open(*rays, i))
            continue;
        ModelTriangle back = turned(model.triangles[i]);
        for (std::uint32_t& vertex : back.vertices) {
            ModelVertex v = model.vertices[vertex];
            v.normal = -v.normal;
            v.tangent.w = -v.tangent.w;
            vertex = static_cast<std::uint32_t>(model.vertices.size());
            model.vertices.push_back(v);
        }
        model.triangles.push_back(back);
    }
    return model;
}

} // namespace tessera::corpus
