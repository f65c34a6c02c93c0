#include "corpus/trace/material_at.h"

#include "corpus/trace/sheen.h"

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

glm::dvec3 face_normal(const Model& model, std::uint32_t triangle) {
    const glm::dvec3 cross = area_vector(model, model.triangles[triangle]);
    const double length = glm::length(cross);
    return length > 0.0 ? cross / length : glm::dvec3(0, 1, 0);
}

// The tangent and bitangent of texture coordinates, from the tangents of the file or, if it has none,
// from the coordinates; nothing where they do not vary.
struct TangentFrame {
    glm::dvec3 t, b;
};
std::optional<TangentFrame> tangents_at(const Model& model, const TextureUse& use,
                                        const Interpolated& at, std::uint32_t triangle,
                                        const glm::dvec3& normal) {
    glm::dvec3 t(at.tangent);
    double sign = at.tangent.w < 0.0 ? -1.0 : 1.0;
    if (at.tangent.w == 0.0) {
        const auto& [a, b, c] = model.triangles[triangle].vertices;
        const auto uv = [&](std::uint32_t v) {
            return use.turn * glm::dvec2(model.vertices[v].uv[use.uv]);
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
        return std::nullopt;
    t /= length;
    return TangentFrame{t, glm::cross(normal, t) * sign};
}

// The normal of a normal map.
glm::dvec3 bent_normal(const Model& model, const TextureUse& use, double scale,
                       const Interpolated& at, std::uint32_t triangle, const glm::dvec3& normal) {
    const glm::dvec4 texel = texture_value(model, use, at.uv, false);
    const glm::dvec3 local = (glm::dvec3(texel) * 2.0 - 1.0) * glm::dvec3(scale, scale, 1.0);
    const auto frame = tangents_at(model, use, at, triangle, normal);
    if (!frame)
        return normal;
    const glm::dvec3 bent = frame->t * local.x + frame->b * local.y + normal * local.z;
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

// The lobes with all that extensions add. `smooth` is the normal without a normal map.
void add_coats(const Model& model, const ModelMaterial& m, const Interpolated& at,
               std::uint32_t triangle, const glm::dvec3& smooth, LitPoint& p) {
    const ModelCoats& from = *m.coats;
    Lobes& lobes = p.lobes;
    lobes.has_coats = true;
    Coats& coats = lobes.coats;
    const auto value = [&](const TextureUse& use, bool is_colour = false) {
        return texture_value(model, use, at.uv, is_colour);
    };
    const auto alpha_of = [](double roughness, double least) {
        const double r = std::clamp(roughness, least, 1.0);
        return r * r;
    };
    coats.clear = from.clear * value(from.clear_texture).r;
    coats.clear_alpha =
        alpha_of(from.clear_roughness * value(from.clear_roughness_texture).g, least_roughness);
    coats.clear_normal = smooth;
    if (from.clear_normal_texture.image >= 0)
        coats.clear_normal = bent_normal(model, from.clear_normal_texture, from.clear_normal_scale,
                                         at, triangle, smooth);
    coats.sheen = glm::min(from.sheen * glm::dvec3(value(from.sheen_texture, true)), 1.0);
    coats.sheen_alpha = std::max(
        alpha_of(from.sheen_roughness * value(from.sheen_roughness_texture).a, least_roughness),
        least_sheen_alpha);
    const glm::dvec4 way = value(from.anisotropy_texture);
    const double strength = from.anisotropy * way.b;
    if (const auto frame = strength > 0.0
                               ? tangents_at(model, from.anisotropy_texture, at, triangle, p.normal)
                               : std::nullopt) {
        const glm::dvec2 turned = from.anisotropy_texture.image < 0
                                      ? glm::dvec2(1.0, 0.0)
                                      : glm::dvec2(way.r, way.g) * 2.0 - 1.0;
        const double c = std::cos(from.rotation), s = std::sin(from.rotation);
        coats.along =
            frame->t * (c * turned.x - s * turned.y) + frame->b * (s * turned.x + c * turned.y);
        coats.along_alpha = glm::mix(lobes.alpha, 1.0, strength * strength);
    }
    coats.film = from.film * value(from.film_texture).r;
    if (coats.film > 0.0) {
        coats.film_ior = from.film_ior;
        coats.film_nanometres =
            glm::mix(from.film_least, from.film_most, value(from.film_thickness_texture).g);
        // What the film mirrors at the steeper angles is not left for diffuse light.
        double most = 0.0;
        for (const double cosine : {1.0, 0.85, 0.7, 0.5})
            most = std::max(most, largest_of(fresnel(lobes, cosine)));
        lobes.diffuse *= std::min(1.0, (1.0 - most) / (1.0 - usual_reflectance));
    }
    if (const double through = from.through * value(from.through_texture).r; through > 0.0) {
        // The colour of a place that is no metal. Metal lets nothing pass.
        const double metal =
            m.has_glossiness ? 0.0
                             : std::clamp(m.metal * value(m.metal_roughness_texture).b, 0.0, 1.0);
        coats.through = base_at(model, m, at) * (through * (1.0 - metal));
        coats.through_alpha = lobes.alpha;
        lobes.diffuse *= 1.0 - through;
        coats.is_volume = from.is_volume;
        coats.ior = m.ior;
        if (from.attenuation_distance > 0.0)
            coats.absorption =
                -glm::log(glm::max(from.attenuation, 1e-6)) / from.attenuation_distance;
    }
}

} // namespace

Interpolated interpolated_at(const Model& model, const ModelPlace& place) {
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

glm::dvec3 emission_at(const Model& model, const ModelMaterial& m, const Interpolated& at) {
    if (m.is_unlit)
        return base_at(model, m, at) * m.unlit_light;
    return m.emission * glm::dvec3(texture_value(model, m.emission_texture, at.uv, true));
}

double alpha_at(const Model& model, const ModelMaterial& m, const Interpolated& at) {
    return m.base.a * at.colour.a * texture_value(model, m.base_texture, at.uv, true).a;
}

double opacity_at(const Model& model, const ModelMaterial& m, const Interpolated& at) {
    return m.blends ? std::clamp(alpha_at(model, m, at), 0.0, 1.0) : 1.0;
}

LitPoint lit_point(const Model& model, const ModelPlace& place) {
    const ModelMaterial& m = model.materials[model.triangles[place.triangle].material];
    const Interpolated at = interpolated_at(model, place);
    LitPoint p;
    p.position = at.position;
    p.face = face_normal(model, place.triangle);
    const double length = glm::length(at.normal);
    const glm::dvec3 smooth = length > 1e-6 ? at.normal / length : p.face;
    p.normal = m.normal_texture.image < 0 ? smooth
                                          : bent_normal(model, m.normal_texture, m.normal_scale, at,
                                                        place.triangle, smooth);
    p.emission = emission_at(model, m, at);
    p.opacity = opacity_at(model, m, at);
    if (m.is_unlit) {
        p.lobes = {glm::dvec3(0.0), glm::dvec3(0.0), 1.0, 0.0};
        return p;
    }
    p.lobes = lobes_at(model, m, at);
    if (m.coats)
        add_coats(model, m, at, place.triangle, smooth, p);
    return p;
}

} // namespace tessera::corpus
