// Textures that are an array of 2D layers.
#pragma once

#include "decoder_glsl/gl/gl_handle.h"
#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tessera {

enum class TexelFormat {
    rgba8,    // 4 bytes, 0..1 in 255 steps
    rgba16f,  // 8 bytes, halves
    rgba32f,  // 16 bytes, floats
    rgba16ui, // 8 bytes, unsigned
    r32ui,    // 4 bytes, an unsigned word
    rg32ui,   // 8 bytes, two of them
};

std::uint32_t texel_bytes(TexelFormat format);

struct TextureShape {
    std::uint32_t width = 0, height = 0; // texels
    std::uint32_t layers = 0;
};

// One level of detail, fixed size and format; sampled without interpolation and clamped to its edge
// unless asked otherwise. Needs a current OpenGL 4.5 context at every call, as its destructor does.
class GlTexture {
public:
    // Content undefined. bad_argument: a side of 0. unsupported: more than the device's
    // GL_MAX_TEXTURE_SIZE or GL_MAX_ARRAY_TEXTURE_LAYERS. runtime: out of memory.
    static Result<GlTexture> create(TexelFormat format, const TextureShape& shape,
                                    const std::string& name);

    GLuint id() const { return handle_.get(); }
    TexelFormat format() const { return format_; }
    const TextureShape& shape() const { return shape_; }
    std::uint64_t bytes() const { return layer_bytes() * shape_.layers; } // without padding
    std::uint64_t layer_bytes() const {
        return std::uint64_t{shape_.width} * shape_.height * texel_bytes(format_);
    }

    // Whole layers from `first` on, rows tightly packed. bad_argument: layers that are not there, or
    // a span that is no multiple of layer_bytes().
    Status upload(std::uint32_t first, std::span<const std::byte> layers);
    // Waits for the device and sees what shaders wrote.
    Status read(std::uint32_t first, std::span<std::byte> layers) const;
    // All texels to zero.
    void clear();
    // All texels to `texel`, texel_bytes(format()) bytes.
    Status clear(std::span<const std::byte> texel);

    // Linear interpolation between texels, or none. Formats of integers have none.
    Status interpolate(bool linear);

    void bind_texture(GLuint unit) const;
    // All layers, for image loads and stores; `access` as GL_WRITE_ONLY. The shader sees them in the
    // format that its image declares, here `as`, bit for bit: r32ui writes packed rgba8 texels.
    // bad_argument: texels of another size.
    void bind_image(GLuint unit, GLenum access) const;
    Status bind_image(GLuint unit, GLenum access, TexelFormat as) const;

private:
    struct Release {
        void operator()(GLuint id) const { glDeleteTextures(1, &id); }
    };
    Status check_layers(const char* what, std::uint32_t first, std::size_t bytes) const;

    GlHandle<Release> handle_;
    TexelFormat format_ = TexelFormat::rgba8;
    TextureShape shape_;
    std::string name_;
};

} // namespace tessera
