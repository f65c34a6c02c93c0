#include "corpus/trace/ray_model.h"

namespace tessera::corpus {
namespace {

// The highlights of smoother materials are thinner than the cell of any direction.
constexpr double least_roughness = 0.03;

std::array<double, 256> make_linear() {
    std::array<double, 256> table{};
    for (std::size_t i = 0; i < 256; ++i)
        table[i] = srgb_to_linear(static_cast<double>(i) / 255.0);
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

// The bilinear value of the texture. Colours become linear light; alpha stays as it is. 1 without a
// texture.
glm::dvec4 texture_value(const Model& model, const TextureUse& use,
                         const std::array<glm::dvec2, 2>& uv, bool is_colour) {
    if (use.image < 0)
        return glm::dvec4(1.0);
    static const std::array<double, 256> linear = make_linear();
    const Image& image = model.images[static_cast<std::size_t>(use.image)];
    const glm::dvec2 place = use.turn * uv[use.uv] + use.offset;
    const double x = place.x * image.width - 0.5, y = place.y * image.height - 0.5;
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

struct Interpolated {
    glm::dvec3 position, normal;
    glm::dvec4 tangent, colour;
    std::array<glm::dvec2, 2> uv;
};

Interpolated interpolate(const Model& model, const ModelPlace& place) {
    const auto& corners = model.triangles[place.triangle].vertices;
    const double w[3] = {1.0 - place.barycentric.x - place.barycentric.y, place.barycentric.x,
                         place.barycentric.y};
    Interpolated sum{glm::dvec3(0.0), glm::dvec3(0.0), glm::dvec4(0.0), glm::dvec4(0.0), {}};
    for (std::size_t k = 0; k < 3; ++k) {
        const ModelVertex& v = model.vertices[corners[k]];
        sum.position += w[k] * glm::dvec3(v.position);
        sum.normal += w[k] * glm::dvec3(v.normal);
        sum.tangent += w[k] * glm::dvec4(v.tangent);
        sum.colour += w[k] * glm::dvec4(v.colour);
        for (std::size_t s = 0; s < 2; ++s)
            sum.uv[s] += w[k] * glm::dvec2(v.uv[s]);
    }
    return sum;
}

glm::dvec3 face_normal(const Model& model, std::uint32_t triangle) {
    const glm::dvec3 cross = area_vector(model, model.triangles[triangle]);
    const double length = glm::length(cross);
    return length > 0.0 ? cross / length : glm::dvec3(0, 1, 0);
}

// The normal of the normal map. Its frame comes from the tangents of the file, or from the texture
// coordinates if the file has none.
glm::dvec3 bent_normal(const Model& model, const ModelMaterial& m, const Interpolated& at,
                       const ModelPlace& place, const glm::dvec3& normal) {
    const glm::dvec4 texel = texture_value(model, m.normal_texture, at.uv, false);
    const glm::dvec3 local =
        (glm::dvec3(texel) * 2.0 - 1.0) * glm::dvec3(m.normal_scale, m.normal_scale, 1.0);
    glm::dvec3 t(at.tangent);
    double sign = at.tangent.w < 0.0 ? -1.0 : 1.0;
    if (at.tangent.w == 0.0) {
        const auto& [a, b, c] = model.triangles[place.triangle].vertices;
        const auto uv = [&](std::uint32_t v) {
            return m.normal_texture.turn * glm::dvec2(model.vertices[v].uv[m.normal_texture.uv]);
        };
        const auto p = [&](std::uint32_t v) { return glm::dvec3(model.vertices[v].position); };
        const glm::dvec2 q = uv(b) - uv(a), r = uv(c) - uv(a);
        const double turn = q.x * r.y - q.y * r.x;
        t = ((p(b) - p(a)) * r.y - (p(c) - p(a)) * q.y) * (turn < 0.0 ? -1.0 : 1.0);
        sign = turn > 0.0 ? -1.0 : 1.0; // v grows downwards, the y of normal maps upwards
    }
    t -= normal * glm::dot(t, normal);
    const double length = glm::length(t);
    if (!(length > 1e-9))
        return normal;
    t /= length;
    const glm::dvec3 bent =
        t * local.x + glm::cross(normal, t) * (sign * local.y) + normal * local.z;
    const double size = glm::length(bent);
    return size > 1e-6 ? bent / size : normal;
}

glm::dvec3 base_at(const Model& model, const ModelMaterial& m, const Interpolated& at) {
    return glm::clamp(glm::dvec3(m.base) * glm::dvec3(at.colour) *
                          glm::dvec3(texture_value(model, m.base_texture, at.uv, true)),
                      0.0, 1.0);
}

double largest_of(const glm::dvec3& x) {
    return std::max({x.x, x.y, x.z});
}

// The lobes of a place that is no metal. What the mirror takes is not left for diffuse light; the
// diffuse lobe itself leaves out what a usual mirror takes.
Lobes dielectric(const glm::dvec3& base, const glm::dvec3& facing, double grazing) {
    Lobes lobes;
    lobes.diffuse = base * ((1.0 - largest_of(facing)) / (1.0 - usual_reflectance));
    lobes.facing = facing;
    lobes.grazing = grazing;
    return lobes;
}

Lobes lobes_at(const Model& model, const ModelMaterial& m, const Interpolated& at) {
    const glm::dvec3 base = base_at(model, m, at);
    Lobes lobes;
    double roughness = m.roughness;
    if (m.has_glossiness) {
        const glm::dvec4 colour = texture_value(model, m.metal_roughness_texture, at.uv, true);
        lobes = dielectric(base, glm::clamp(m.specular_colour * glm::dvec3(colour), 0.0, 1.0), 1.0);
        roughness = 1.0 - (1.0 - roughness) * colour.a;
    } else {
        const glm::dvec4 mr = texture_value(model, m.metal_roughness_texture, at.uv, false);
        const double metal = std::clamp(m.metal * mr.b, 0.0, 1.0);
        roughness *= mr.g;
        const bool is_usual = m.reflectance == usual_reflectance && m.specular == 1.0 &&
                              m.specular_colour == glm::dvec3(1.0) &&
                              m.specular_texture.image < 0 && m.specular_colour_texture.image < 0;
        if (is_usual) {
            lobes.diffuse = base * (1.0 - metal);
            lobes.facing = glm::mix(glm::dvec3(usual_reflectance), base, metal);
        } else {
            const double weight =
                m.specular * texture_value(model, m.specular_texture, at.uv, false).a;
            const glm::dvec3 colour =
                m.specular_colour *
                glm::dvec3(texture_value(model, m.specular_colour_texture, at.uv, true));
            lobes = dielectric(base, glm::min(m.reflectance * colour, glm::dvec3(1.0)) * weight,
                               weight);
            lobes.diffuse *= 1.0 - metal;
            lobes.facing = glm::mix(lobes.facing, base, metal);
            lobes.grazing = glm::mix(lobes.grazing, 1.0, metal);
        }
    }
    roughness = std::clamp(roughness, least_roughness, 1.0);
    lobes.alpha = roughness * roughness;
    return lobes;
}

glm::dvec3 emission_at(const Model& model, const ModelMaterial& m, const Interpolated& at) {
    if (m.is_unlit)
        return base_at(model, m, at) * m.unlit_light;
    return m.emission * glm::dvec3(texture_value(model, m.emission_texture, at.uv, true));
}

bool cut_out(const Model& model, const ModelPlace& place) {
    const ModelMaterial& m = model.materials[model.triangles[place.triangle].material];
    if (m.cutoff <= 0.0)
        return false;
    const Interpolated at = interpolate(model, place);
    return m.base.a * at.colour.a * texture_value(model, m.base_texture, at.uv, true).a < m.cutoff;
}

} // namespace

RayModel::RayModel(Model model) : model_(std::move(model)) {}

Result<std::shared_ptr<const RayModel>> RayModel::make(Model model) {
    std::shared_ptr<RayModel> made(new RayModel(std::move(model)));
    std::vector<glm::vec3> positions;
    for (const ModelVertex& v : made->model_.vertices)
        positions.push_back(v.position);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (const ModelTriangle& t : made->model_.triangles)
        triangles.push_back(t.vertices);
    const auto passes = [&m = made->model_](std::uint32_t triangle, const glm::dvec2& barycentric) {
        return cut_out(m, {triangle, barycentric});
    };
    TESSERA_TRY_ASSIGN(made->fronts_, RayScene::make(positions, triangles, true, passes));
    TESSERA_TRY_ASSIGN(made->all_, RayScene::make(positions, triangles, false));
    return std::shared_ptr<const RayModel>(std::move(made));
}

std::optional<ModelPlace> RayModel::first_hit(const glm::dvec3& origin,
                                              const glm::dvec3& direction) const {
    const auto hit = fronts_->first_hit(origin, direction);
    if (!hit)
        return std::nullopt;
    return ModelPlace{hit->triangle, hit->barycentric};
}

bool RayModel::is_blocked(const glm::dvec3& origin, const glm::dvec3& direction,
                          double reach) const {
    return fronts_->is_blocked(origin, direction, reach);
}

bool RayModel::meets_back(const glm::dvec3& origin, const glm::dvec3& direction) const {
    const auto hit = all_->first_hit(origin, direction);
    return hit && hit->back;
}

bool RayModel::is_walled(const glm::dvec3& origin, const glm::dvec3& direction) const {
    return all_->is_blocked(origin, direction);
}

bool RayModel::is_cut_out(const ModelPlace& place) const {
    return cut_out(model_, place);
}

glm::dvec3 RayModel::emission(const ModelPlace& place) const {
    const ModelMaterial& m = model_.materials[model_.triangles[place.triangle].material];
    if (m.emission_texture.image < 0 && !m.is_unlit)
        return m.emission;
    return emission_at(model_, m, interpolate(model_, place));
}

LitPoint RayModel::point(const ModelPlace& place) const {
    const ModelMaterial& m = model_.materials[model_.triangles[place.triangle].material];
    const Interpolated at = interpolate(model_, place);
    LitPoint p;
    p.position = at.position;
    p.face = face_normal(model_, place.triangle);
    const double length = glm::length(at.normal);
    p.normal = length > 1e-6 ? at.normal / length : p.face;
    if (m.normal_texture.image >= 0)
        p.normal = bent_normal(model_, m, at, place, p.normal);
    p.lobes =
        m.is_unlit ? Lobes{glm::dvec3(0.0), glm::dvec3(0.0), 1.0, 0.0} : lobes_at(model_, m, at);
    p.emission = emission_at(model_, m, at);
    return p;
}

} // namespace tessera::corpus
