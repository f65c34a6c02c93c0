// Prepares shaders/layered_mesh.frag.glsl for the layers of a file.
#include "decoder_glsl/draw/view_drawing.h"
#include "decoder_glsl/gl/gl_buffer.h"
#include "decoder_glsl/residency/gl_residency.h"

#include <algorithm>
#include <cctype>

namespace tessera {
namespace {

constexpr GLuint layers_binding = 1; // of the uniform block TesseraLayers
constexpr std::size_t most_textures = value_names<LayerRole>.size();

// TESSERA_LAYER_NORMAL, for example.
std::string macro_of(LayerRole role) {
    std::string name = std::string("TESSERA_LAYER_") + name_of(role);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return name;
}

std::vector<ShaderDefine> defines_of(std::span<const ViewLayer> layers, std::size_t lights) {
    std::vector<ShaderDefine> defines = layers[0].texture->defines();
    defines.emplace_back("TESSERA_TEXTURES", std::to_string(layers.size()));
    for (std::size_t i = 1; i < layers.size(); ++i)
        defines.emplace_back(macro_of(layers[i].role), std::to_string(i));
    if (lights > 0)
        defines.emplace_back("TESSERA_LIGHTS", std::to_string(lights));
    return defines;
}

// The uniform block TesseraLayers in std140 layout.
std::vector<std::array<float, 4>> block_of(std::span<const ViewLayer> layers,
                                           std::span<const DistantLight> lights) {
    std::vector<std::array<float, 4>> block;
    for (const ViewLayer& layer : layers)
        block.push_back({layer.scale, layer.transfer == Transfer::srgb ? 1.0f : 0.0f, 0.0f, 0.0f});
    const std::vector<double> peaks = visibility_peaks(lights);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const glm::vec3 &d = lights[i].direction, &e = lights[i].irradiance;
        block.push_back({d.x, d.y, d.z, lights[i].spread});
        block.push_back({e.x, e.y, e.z, static_cast<float>(peaks[i])});
    }
    return block;
}

Status check_layers(std::span<const ViewLayer> layers) {
    if (layers.empty() || layers.size() > most_textures || layers[0].role != LayerRole::diffuse)
        return {ErrorCode::bad_argument,
                "layers to draw begin with the diffuse one, and no role occurs twice"};
    for (const ViewLayer& layer : layers)
        if (layer.texture->defines() != layers[0].texture->defines())
            return {ErrorCode::bad_argument, "the textures of layers differ in their options"};
    return {};
}

// Checks that the device's limit `query` is at least `needed`.
Status check_limit(GLenum query, const char* name, std::size_t needed) {
    GLint offered = 0;
    glGetIntegerv(query, &offered);
    if (needed <= static_cast<std::size_t>(offered))
        return {};
    return {ErrorCode::unsupported, std::string(name) + " of " + std::to_string(needed) +
                                        " is needed for these layers, this device offers " +
                                        std::to_string(offered)};
}

} // namespace

Result<MeshLook> layered_look(std::span<const ViewLayer> layers,
                              std::span<const DistantLight> lights) {
    TESSERA_TRY(check_layers(layers));
    const auto block = block_of(layers, lights);
    const auto bytes = std::as_bytes(std::span(block));
    TESSERA_TRY(check_limit(GL_MAX_UNIFORM_BLOCK_SIZE, "GL_MAX_UNIFORM_BLOCK_SIZE", bytes.size()));
    const std::size_t buffers = layers.size() + (layers[0].texture->cache_slots() > 0 ? 1 : 0);
    TESSERA_TRY(check_limit(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS,
                            "GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS", sampler_binding + buffers));
    TESSERA_TRY(check_limit(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS,
                            "GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS", buffers));
    MeshLook look;
    const std::string_view name = "layered_mesh.frag.glsl";
    const std::vector<ShaderDefine> defines = defines_of(layers, lights.size());
    TESSERA_TRY_ASSIGN(look.fragment, shader_source(name, ShaderDialect::gl450, defines));
    const auto has = [&](LayerRole role) {
        return std::ranges::find(layers, role, &ViewLayer::role) != layers.end();
    };
    const auto source_with = [&](const char* macro) {
        std::vector<ShaderDefine> all = defines;
        all.emplace_back(macro, "1");
        return shader_source(name, ShaderDialect::gl450, all);
    };
    if (has(LayerRole::coverage) || has(LayerRole::opacity)) {
        TESSERA_TRY_ASSIGN(look.depth_fragment, source_with("TESSERA_COVERAGE_ONLY"));
    }
    if (has(LayerRole::opacity)) {
        TESSERA_TRY_ASSIGN(look.blended_fragment, source_with("TESSERA_BLENDED"));
    }
    TESSERA_TRY_ASSIGN(GlBuffer buffer, GlBuffer::create(bytes, "layers and lights"));
    look.bytes = buffer.bytes();
    look.bind = [textures = std::vector(layers.begin(), layers.end()),
                 uniforms = std::make_shared<GlBuffer>(std::move(buffer))] {
        for (unsigned i = 0; i < textures.size(); ++i)
            textures[i].texture->bind(i);
        uniforms->bind_uniforms(layers_binding, uniforms->bytes());
    };
    return look;
}

} // namespace tessera
