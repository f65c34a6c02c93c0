#include "corpus/model/turned_vertex.h"
#include "corpus/trace/path_random.h"
#include "corpus/trace/ray_model.h"

namespace tessera::corpus {
namespace {

constexpr unsigned trials = 64;

ModelTriangle turned(const ModelTriangle& triangle) {
    return {{triangle.vertices[0], triangle.vertices[2], triangle.vertices[1]},
            triangle.material,
            true};
}

// Whether test(place, random) is true at one of several random places of the triangle.
template <class Test>
bool at_any_place(std::uint32_t triangle, std::uint64_t sequence, const Test& test) {
    for (unsigned i = 0; i < trials; ++i) {
        PathRandom random(sequence, i);
        glm::dvec2 b = random.next2();
        if (b.x + b.y > 1.0)
            b = 1.0 - b;
        if (test(ModelPlace{triangle, b}, random))
            return true;
    }
    return false;
}

// Whether a ray from the back of the triangle leaves the model.
bool is_open(const RayModel& rays, std::uint32_t triangle) {
    return at_any_place(triangle, 0, [&](const ModelPlace& place, PathRandom& random) {
        const LitPoint p = rays.point(place);
        const glm::dvec3 d = sample_cosine(-p.face, random.next2());
        return !rays.is_walled(p.position - 1e-3 * p.face, d);
    });
}

// Whether alpha leaves a part of the triangle.
bool is_visible(const RayModel& rays, std::uint32_t triangle) {
    return at_any_place(
        triangle, 1, [&](const ModelPlace& place, PathRandom&) { return !rays.is_cut_out(place); });
}

bool has_backs_or_alpha(const Model& model) {
    for (const ModelMaterial& m : model.materials)
        if (m.double_sided || m.cutoff > 0.0 || m.blends)
            return true;
    return false;
}

} // namespace

Result<Model> with_both_sides(Model model) {
    if (!has_backs_or_alpha(model))
        return model;
    TESSERA_TRY_ASSIGN(const auto rays, RayModel::make(model));
    const std::vector<ModelTriangle> before = std::move(model.triangles);
    model.triangles.clear();
    for (std::uint32_t i = 0; i < before.size(); ++i) {
        if (!is_visible(*rays, i))
            continue;
        model.triangles.push_back(before[i]);
        const ModelMaterial& m = model.materials[before[i].material];
        const bool is_volume = m.coats && m.coats->is_volume && m.coats->through > 0.0;
        if (!m.double_sided || is_volume || !is_open(*rays, i))
            continue;
        ModelTriangle back = turned(before[i]);
        for (std::uint32_t& vertex : back.vertices) {
            const ModelVertex v = turned_vertex(model.vertices[vertex]);
            vertex = static_cast<std::uint32_t>(model.vertices.size());
            model.vertices.push_back(v);
        }
        model.triangles.push_back(back);
    }
    if (model.triangles.empty())
        return Status(ErrorCode::invalid_file, "its alpha removes all triangles");
    return model;
}

} // namespace tessera::corpus
