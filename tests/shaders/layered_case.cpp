// layered_case OUT: writes two squares with a texture for every role of a layer, and the picture that the CPU
// draws of it, for layered.mjs. OUT is a list of arrays (case_file.h):
//   facts       width and height of the picture, number of lights
//   words       the sampler's words of all textures, one after the other
//   parameters  their headers
//   texture     of each layer in the order of LayerRole
//   layers      the uniform block TesseraLayers, as far as it is used
//   view        the uniform block TesseraMeshView
//   vertices    position, normal, tangent, uv: 11 floats for each corner of each triangle
//   picture     three floats per pixel: display values
#include "tests/shaders/case_file.h"
#include "tests/support/memory_texture.h"
#include "tools/view/layered_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/glm.hpp>
#include <memory>

namespace tessera {
namespace {

using namespace layout;

constexpr std::uint32_t picture_side = 96; // pixels
constexpr std::uint32_t light_count = 5;

struct LayerShape {
    LayerRole role;
    Extent4 size;
    std::uint8_t channels;
    float scale;
    Transfer transfer = Transfer::linear;
};

// In the order of LayerRole, so that the number of a texture is its role.
const LayerShape shapes[] = {
    {LayerRole::diffuse, {64, 64, 1, 1}, 3, 0.4f, Transfer::srgb},
    {LayerRole::emission, {32, 32, 1, 1}, 3, 0.1f},
    {LayerRole::specular, {64, 64, 1, 1}, 3, 0.5f},
    {LayerRole::roughness, {64, 64, 1, 1}, 1, 0.6f},
    {LayerRole::normal, {64, 64, 1, 1}, 2, 1.0f},
    {LayerRole::visibility, {32, 32, 3, 2}, 1, 1.0f},
    {LayerRole::reflection, {16, 16, 6, 6}, 3, 0.3f},
    {LayerRole::coverage, {64, 64, 1, 1}, 1, 1.0f},
    {LayerRole::environment, {4, 1, 16, 16}, 3, 0.3f},
    {LayerRole::difference, {16, 16, 6, 6}, 3, 0.05f},
    {LayerRole::shared_difference, {1, 1, 12, 12}, 3, 0.05f},
    {LayerRole::opacity, {64, 64, 1, 1}, 1, 1.0f},
};

double wave(double x) {
    return 0.5 + 0.5 * std::sin(x);
}

// Smooth values, because the picture is a matter of sampling and light, not of noise. Normals point
// nearly away from the mesh, a corner of the atlas is not covered, and its right half is translucent.
double sample_of(LayerRole role, int u, int v, int s, int t, int c) {
    const double smooth = wave(0.31 * u + 0.17 * v + 0.9 * s - 0.7 * t + c);
    if (role == LayerRole::normal)
        return (128.0 + 40.0 * (smooth - 0.5)) / 255.0;
    if (role == LayerRole::coverage)
        return u < 12 && v < 12 ? 0.0 : 1.0;
    if (role == LayerRole::opacity)
        return u < 32 ? 1.0 : 0.3 + 0.4 * smooth;
    return is_signed(role) ? 0.3 + 0.4 * smooth : smooth;
}

// A translucent square in front of an opaque one that fills the picture.
SurfaceMesh squares() {
    struct Square {
        float left, z, begin, side; // left: of its chart; begin and side: of its x and y
    };
    SurfaceMesh mesh;
    for (const Square& square :
         {Square{0.53f, 0.2f, 0.3f, 0.5f}, Square{0.02f, 0.0f, 0.0f, 1.0f}}) {
        const auto first = static_cast<std::uint32_t>(mesh.uv.size());
        for (const glm::vec2 corner :
             {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
            mesh.uv.emplace_back(square.left + 0.45f * corner.x, 0.02f + 0.96f * corner.y);
            mesh.positions.emplace_back(square.begin + square.side * corner, square.z);
            mesh.normals.emplace_back(glm::normalize(glm::vec3(0.3f * (corner - 0.5f), 1.0f)));
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    return mesh;
}

std::vector<DistantLight> lights() {
    std::vector<DistantLight> all;
    for (std::uint32_t i = 0; i < light_count; ++i) {
        const float angle = 1.3f * static_cast<float>(i);
        all.push_back({.direction = glm::normalize(
                           glm::vec3(0.4f * std::cos(angle), 0.4f * std::sin(angle), 1.0f)),
                       .spread = i % 2 == 0 ? 0.0f : 0.2f,
                       .irradiance = glm::vec3(0.8f, 0.5f, 0.3f) * (1.0f + 0.2f * angle)});
    }
    return all;
}

void add_textures(const SurfaceMesh& mesh,
                  std::span<const std::unique_ptr<test::MemoryTexture>> sources, Arrays& out) {
    Words all, parameters;
    for (std::size_t i = 0; i < std::size(shapes); ++i) {
        const TileGrid grid(shapes[i].size, shapes[i].size);
        const AtlasMips mips(mesh, grid);
        const auto with_mips = make_mip_source(*sources[i], mips, shapes[i].size[axis_v]);
        Words words = plain_words(grid, mips, AngularMap::octahedral_mirrored);
        words[tsr_p_words_at] = static_cast<std::uint32_t>(all.size());
        parameters.insert(parameters.end(), words.begin(), words.begin() + tsr_sampler_words);
        all.insert(all.end(), words.begin(), words.end());
        out.add("texture", all_pixels(with_mips->desc(), all_texels(*with_mips)));
    }
    out.add("words", all);
    out.add("parameters", parameters);
}

void add_blocks(std::span<const DistantLight> sun, const Camera& camera, Arrays& out) {
    std::vector<float> layers;
    const auto put = [&](const glm::vec3& xyz, float w) {
        layers.insert(layers.end(), {xyz.x, xyz.y, xyz.z, w});
    };
    for (const LayerShape& shape : shapes)
        put({shape.scale, shape.transfer == Transfer::srgb ? 1.0f : 0.0f, 0.0f}, 0.0f);
    const std::vector<double> peaks = visibility_peaks(sun);
    for (std::size_t i = 0; i < sun.size(); ++i) {
        put(sun[i].direction, sun[i].spread);
        put(sun[i].irradiance, static_cast<float>(peaks[i]));
    }
    out.add("layers", std::as_bytes(std::span(layers)));

    // Clip coordinates of a position p from the eye: p along right and up in units of these, a depth
    // of 0 to 1 for distances of 0.5 to 2 along forward, and that distance.
    const glm::dvec3 right = camera.right / glm::dot(camera.right, camera.right);
    const glm::dvec3 up = camera.up / glm::dot(camera.up, camera.up);
    constexpr double near = 0.5, far = 2.0, depth = far / (far - near);
    const glm::dvec4 rows[] = {
        {right, 0.0}, {up, 0.0}, {depth * camera.forward, -near * depth}, {camera.forward, 0.0}};
    std::vector<float> view; // columns first
    for (int column = 0; column < 4; ++column)
        for (const glm::dvec4& row : rows)
            view.push_back(static_cast<float>(row[column]));
    for (int i = 0; i < 3; ++i)
        view.push_back(static_cast<float>(camera.eye[i]));
    view.push_back(0.0f);
    out.add("view", std::as_bytes(std::span(view)));
}

void add_vertices(const SurfaceMesh& mesh, Arrays& out) {
    const auto tangents = mesh_tangents(mesh);
    std::vector<float> vertices;
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t i : triangle) {
            for (const glm::vec3& vector : {mesh.positions[i], mesh.normals[i], tangents[i]})
                vertices.insert(vertices.end(), {vector.x, vector.y, vector.z});
            vertices.insert(vertices.end(), {mesh.uv[i].x, mesh.uv[i].y});
        }
    out.add("vertices", std::as_bytes(std::span(vertices)));
}

int run(const char* to) {
    const SurfaceMesh mesh = squares();
    std::vector<std::unique_ptr<test::MemoryTexture>> sources;
    std::vector<DrawnLayer> drawn;
    for (const LayerShape& shape : shapes) {
        TextureDesc desc;
        desc.size = shape.size;
        desc.channels = shape.channels;
        sources.push_back(
            std::make_unique<test::MemoryTexture>(desc, [&](int u, int v, int s, int t, int c) {
                return sample_of(shape.role, u, v, s, t, c);
            }));
        drawn.push_back({.role = shape.role,
                         .scale = shape.scale,
                         .texels = sources.back().get(),
                         .tile = shape.size,
                         .transfer = shape.transfer});
    }
    const auto sun = lights();
    const Camera camera =
        must(make_camera({.eye = {0.55, 0.45, 1.2}, .look = {0.5, 0.5, 0.0}},
                         {.fov = 38, .width = picture_side, .height = picture_side}));
    RenderOptions options;
    options.threads = 1;
    const auto renderer = must(make_layered_renderer(drawn, sun, mesh, glm::dvec3(0.0), options));
    const View picture = must(renderer->render(camera));

    Arrays out(to);
    out.add("facts", Words{picture.width, picture.height, light_count});
    add_textures(mesh, sources, out);
    add_blocks(sun, camera, out);
    add_vertices(mesh, out);
    out.add("picture", std::as_bytes(std::span(picture.rgb)));
    must(out.finish());
    return 0;
}

} // namespace
} // namespace tessera

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: layered_case OUT\n");
        return 1;
    }
    return tessera::run(argv[1]);
}
