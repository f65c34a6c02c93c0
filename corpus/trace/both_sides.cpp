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

// Whether the alpha mask leaves something of it, at random places.
bool is_there(const RayModel& rays, std::uint32_t triangle) {
    for (unsigned i = 0; i < ways; ++i) {
        PathRandom random(1, i);
        glm::dvec2 b = random.next2();
        if (b.x + b.y > 1.0)
            b = 1.0 - b;
        if (!rays.is_cut_out({triangle, b}))
            return true;
    }
    return false;
}

bool needs_a_look(const Model& model) {
    for (const ModelMaterial& m : model.materials)
        if (m.double_sided || m.cutoff > 0.0)
            return true;
    return false;
}

} // namespace

Result<Model> with_both_sides(Model model) {
    if (!needs_a_look(model))
        return model;
    TESSERA_TRY_ASSIGN(const auto rays, RayModel::make(model));
    const std::vector<ModelTriangle> before = std::move(model.triangles);
    model.triangles.clear();
    for (std::uint32_t i = 0; i < before.size(); ++i) {
        if (!is_there(*rays, i))
            continue;
        model.triangles.push_back(before[i]);
        if (!model.materials[before[i].material].double_sided || !is_open(*rays, i))
            continue;
        ModelTriangle back = turned(before[i]);
        for (std::uint32_t& vertex : back.vertices) {
            ModelVertex v = model.vertices[vertex];
            v.normal = -v.normal;
            v.tangent.w = -v.tangent.w;
            vertex = static_cast<std::uint32_t>(model.vertices.size());
            model.vertices.push_back(v);
        }
        model.triangles.push_back(back);
    }
    if (model.triangles.empty())
        return Status(ErrorCode::invalid_file, "the alpha masks of the model leave nothing of it");
    return model;
}

} // namespace tessera::corpus
