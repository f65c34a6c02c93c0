#include "corpus/layers/model_layers.h"

#include "corpus/layers/distant_lights.h"
#include "corpus/trace/path_random.h"
#include "format/samples.h"

#include <cmath>
#include <glm/common.hpp>

namespace tessera::corpus {
namespace {

constexpr std::uint64_t reflection_paths = 0x72666C63;
// Places of a texel at which its material is read.
constexpr std::array<glm::dvec2, 4> material_places{
    {{-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}};

double to_srgb(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
}

std::byte to_unorm8(double x) {
    return static_cast<std::byte>(static_cast<unsigned>(255.0 * std::clamp(x, 0.0, 1.0) + 0.5));
}

LayerTexture make_texture(LayerRole role, const Extent4& size, std::uint8_t channels) {
    LayerTexture texture;
    texture.role = role;
    texture.desc = {size, SampleType::unorm8, channels};
    texture.texels.assign(texture.desc.box_bytes(Box4::whole(size)), std::byte{0});
    return texture;
}

void make_mask(LayerTexture& texture, const Extent4& size) {
    texture.mask_desc = {size, SampleType::unorm8, 1};
    texture.mask.assign(texel_count(size), std::byte{0});
}

// Light in linear values, before its scale is known.
struct LightPlane {
    std::vector<glm::vec3> values;
    // The scale such that few values are clipped.
    double scale() const {
        float most = 0;
        for (const glm::vec3& x : values)
            most = std::max({most, x.x, x.y, x.z});
        return std::max(1e-3, static_cast<double>(most));
    }
};

void store_light(const LightPlane& plane, LayerTexture& texture) {
    texture.transfer = Transfer::srgb;
    for (std::size_t i = 0; i < plane.values.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c)
            texture.texels[3 * i + static_cast<std::size_t>(c)] =
                to_unorm8(to_srgb(static_cast<double>(plane.values[i][c]) / texture.scale));
}

class Baker {
public:
    Baker(const ModelPlaces& coarse, const ModelPlaces& fine, const Tracer& tracer,
          const PlaceLight& light, const ModelLayersOptions& options, ModelLayers& out)
        : coarse_(coarse), fine_(fine), tracer_(tracer), light_(light), options_(options),
          out_(out) {}

    Status bake() {
        TESSERA_TRY(bake_materials());
        if (!out_.lights.empty())
            TESSERA_TRY(bake_visibility());
        return bake_reflection();
    }

private:
    Status bake_materials();
    Status bake_visibility();
    Status bake_reflection();
    glm::dvec3 reflection(const std::vector<Texels2>& places, double s, double t) const;

    const ModelPlaces& coarse_;
    const ModelPlaces& fine_;
    const Tracer& tracer_;
    const PlaceLight& light_;
    const ModelLayersOptions& options_;
    ModelLayers& out_;
};

Status Baker::bake_materials() {
    const Texels2 size = fine_.texel_places().size();
    const Extent4 whole{size[0], size[1], 1, 1};
    LayerTexture diffuse = make_texture(LayerRole::diffuse, whole, 3),
                 specular = make_texture(LayerRole::specular, whole, 3),
                 roughness = make_texture(LayerRole::roughness, whole, 1),
                 normal = make_texture(LayerRole::normal, whole, 2);
    for (LayerTexture* texture : {&diffuse, &specular, &roughness, &normal})
        make_mask(*texture, whole);
    LightPlane light{std::vector<glm::vec3>(fine_.texels(), glm::vec3(0.0f))};
    const double step = options_.light_texel;
    TESSERA_TRY(for_rows("baking materials", size[1], options_.run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < size[0]; ++u) {
            if (!fine_.texel_places().matters(u, v))
                continue;
            glm::dvec3 leaving(0.0), facing(0.0);
            glm::dvec2 bump(0.0);
            double rough = 0;
            double lit = 0;
            for (const glm::dvec2& offset : material_places) {
                const ModelSurfacePlace at = fine_.place(u, v, offset);
                const glm::dvec2 texel = (glm::dvec2(u + 0.5, v + 0.5) + offset) / step;
                if (const auto arriving = light_.diffuse(texel, at.point.normal)) {
                    leaving += at.point.lobes.diffuse * *arriving;
                    ++lit;
                }
                facing += at.point.lobes.facing;
                rough += std::sqrt(at.point.lobes.alpha);
                bump += glm::dvec2(glm::dot(at.point.normal, at.frame.ex),
                                   glm::dot(at.point.normal, at.frame.ey));
            }
            const std::size_t i = std::size_t{v} * size[0] + u;
            if (lit == 0.0)
                continue;
            constexpr double count = material_places.size();
            light.values[i] = glm::vec3(leaving * (options_.exposure / lit));
            for (glm::length_t c = 0; c < 3; ++c)
                specular.texels[3 * i + static_cast<std::size_t>(c)] =
                    to_unorm8(to_srgb(facing[c] / count));
            roughness.texels[i] = to_unorm8(rough / count);
            for (glm::length_t c = 0; c < 2; ++c)
                normal.texels[2 * i + static_cast<std::size_t>(c)] = static_cast<std::byte>(
                    static_cast<int>(std::lround(128.0 + 127.0 * bump[c] / count)));
            for (LayerTexture* texture : {&diffuse, &specular, &roughness, &normal})
                texture->mask[i] = std::byte{1};
        }
    }));
    diffuse.scale = std::min(light.scale(), 1.0);
    store_light(light, diffuse);
    specular.transfer = Transfer::srgb;
    for (LayerTexture* texture : {&diffuse, &specular, &roughness, &normal})
        out_.layers.push_back(std::move(*texture));
    return {};
}

Status Baker::bake_visibility() {
    constexpr double deep_below = -0.3; // no bump turns there
    const Texels2 size = coarse_.texel_places().size();
    std::uint32_t side = 1;
    while (side * side < out_.lights.size())
        ++side;
    const Extent4 whole{size[0], size[1], side, side};
    LayerTexture texture = make_texture(LayerRole::visibility, whole, 1);
    make_mask(texture, whole);
    texture.tile = {16, 16, side, side};
    const std::vector<double> peaks = visibility_peaks(out_.lights);
    TESSERA_TRY(for_rows("baking visibility", size[1], options_.run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < size[0]; ++u) {
            if (!light_.matters(u, v))
                continue;
            const glm::dvec3 normal = coarse_.place(u, v, {0.0, 0.0}).frame.ez;
            const std::size_t first = (std::size_t{v} * size[0] + u) * side * side;
            for (std::size_t j = 0; j < out_.lights.size(); ++j) {
                texture.texels[first + j] =
                    to_unorm8(peaks[j] * light_.visibility(u, v, j) / 255.0);
                if (glm::dot(normal, glm::dvec3(out_.lights[j].direction)) > deep_below)
                    texture.mask[first + j] = std::byte{1};
            }
        }
    }));
    out_.layers.push_back(std::move(texture));
    return {};
}

glm::dvec3 Baker::reflection(const std::vector<Texels2>& places, double s, double t) const {
    const bool distant = out_.lights.empty();
    glm::dvec3 sum(0.0);
    double weights = 0;
    for (unsigned i = 0; i < options_.samples; ++i) {
        PathRandom random(mix_bits(options_.light.seed + reflection_paths), i);
        const double which = random.next();
        const Texels2& texel =
            places[std::min(static_cast<std::size_t>(which * static_cast<double>(places.size())),
                            places.size() - 1)];
        ModelSurfacePlace at = coarse_.place(texel[0], texel[1], random.next2() - 0.5);
        at.point.normal = at.frame.ez;
        const glm::dvec3 n = at.frame.ez;
        glm::dvec3 view = octahedral_direction(AngularMap::octahedral_mirrored, at.frame, s, t);
        view -= 2.0 * std::min(glm::dot(view, n), 0.0) * n;
        const double nv = std::max(glm::dot(view, n), 0.02);
        const glm::dvec3 l = sample_ggx(at.point.lobes.alpha, n, view, random.next2());
        const double nl = glm::dot(n, l);
        if (nl <= 0.0 || glm::dot(at.point.face, l) <= 0.0)
            continue;
        // The rest of the lobe after its density of sample_ggx(): G2 / G1.
        const double a = at.point.lobes.alpha;
        const double weight = 2.0 * nl * (nv + smith_root(a, nv)) * smith_visibility(a, nl, nv);
        sum += weight * tracer_.from(at.point, l, distant, random);
        weights += weight;
    }
    return weights > 0.0 ? sum * (options_.exposure / weights) : glm::dvec3(0.0);
}

Status Baker::bake_reflection() {
    const std::uint32_t step = std::max(options_.reflection_texel / options_.light_texel, 1u);
    const Texels2 all = coarse_.texel_places().size();
    const Texels2 size{(all[0] + step - 1) / step, (all[1] + step - 1) / step};
    const auto [columns, rows] = options_.directions;
    const Extent4 whole{size[0], size[1], columns, rows};
    LayerTexture texture = make_texture(LayerRole::reflection, whole, 3);
    make_mask(texture, {size[0], size[1], 1, 1});
    texture.tile = {16, 16, columns, rows};
    LightPlane light{std::vector<glm::vec3>(texel_count(whole), glm::vec3(0.0f))};
    TESSERA_TRY(for_rows("baking reflections", size[1], options_.run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < size[0]; ++u) {
            std::vector<Texels2> places;
            for (std::uint32_t y = v * step; y < std::min((v + 1) * step, all[1]); ++y)
                for (std::uint32_t x = u * step; x < std::min((u + 1) * step, all[0]); ++x)
                    if (light_.matters(x, y))
                        places.push_back({x, y});
            if (places.empty())
                continue;
            const std::size_t cell = std::size_t{v} * size[0] + u;
            texture.mask[cell] = std::byte{1};
            for (std::uint32_t t = 0; t < rows; ++t)
                for (std::uint32_t s = 0; s < columns; ++s)
                    light.values[(cell * rows + t) * columns + s] =
                        glm::vec3(reflection(places, (s + 0.5) / columns, (t + 0.5) / rows));
        }
    }));
    texture.scale = light.scale();
    store_light(light, texture);
    out_.layers.push_back(std::move(texture));
    return {};
}

} // namespace

Result<ModelLayers> bake_model_layers(const Model& model, const ModelLight& light,
                                      const ModelLayersOptions& options) {
    ModelAtlasOptions layout;
    const double step = options.light_texel;
    layout.density = options.density / step;
    layout.texels = options.texels / (step * step);
    layout.tile = {16, 16};
    layout.finer = options.light_texel;
    TESSERA_TRY_ASSIGN(ModelAtlas atlas, make_model_atlas(model, layout));
    ModelLayers out;
    out.mesh = atlas.stream;
    out.decoded_mesh = atlas.mesh;
    out.charts = atlas.charts.size();
    out.density = atlas.density * step;
    TESSERA_TRY_ASSIGN(const ModelPlaces coarse, ModelPlaces::make(std::move(atlas)));
    TESSERA_TRY_ASSIGN(const ModelPlaces fine, coarse.finer(options.light_texel));
    const Tracer tracer(coarse.model(), light);
    if (options.lights > 0)
        out.lights = distant_lights(light, options.lights, options.exposure);
    TESSERA_TRY_ASSIGN(const PlaceLight places,
                       PlaceLight::make(coarse, tracer, out.lights, options.light, options.run));
    TESSERA_TRY(Baker(coarse, fine, tracer, places, options, out).bake());
    return out;
}

} // namespace tessera::corpus
