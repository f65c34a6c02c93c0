// Textures that are arrays of 2D layers.
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
    r32ui,    // 4 bytes, one unsigned word
};

std::uint32_t texel_bytes(TexelFormat format);

struct TextureShape {
    std::uint32_t width = 0, height = 0; // texels
    std::uint32_t layers = 0;
};

// A texture of fixed size and format with one level of detail. Samples are clamped to its edge and,
// by default, not interpolated. Every call and the destructor need a current OpenGL 4.5 context.
class GlTexture {
public:
    // A texture of undefined content. Errors: bad_argument (a side of 0), unsupported (above the
    // device's GL_MAX_TEXTURE_SIZE or GL_MAX_ARRAY_TEXTURE_LAYERS), runtime (out of memory).
    static Result<GlTexture> create(TexelFormat format, const TextureShape& shape,
                                    const std::string& name);

    GLuint id() const { return handle_.get(); }
    const TextureShape& shape() const { return shape_; }
    std::uint64_t bytes() const { return layer_bytes() * shape_.layers; } // without padding
    std::uint64_t layer_bytes() const {
        return std::uint64_t{shape_.width} * shape_.height * texel_bytes(format_);
    }

    // Writes whole layers from `first` on, with tightly packed rows. Errors: bad_argument (layers
    // that do not exist, or a span that is not a multiple of layer_bytes()).
    Status upload(std::uint32_t first, std::span<const std::byte> layers);
    // Reads whole layers. Waits for the device and sees what shaders wrote.
    Status read(std::uint32_t first, std::span<std::byte> layers) const;
    // Sets all texels to zero.
    void clear();
    // Sets all texels to `texel`, which has texel_bytes() of the texture's format.
    Status clear(std::span<const std::byte> texel);

    // Switches linear interpolation on or off. Errors: bad_argument (a format of integers has
    // none).
    Status interpolate(bool linear);

    void bind_texture(GLuint unit) const;
    // Binds all layers for image loads and stores; `access` is GL_WRITE_ONLY, for example. `as` is
    // the format that the shader declares for the image. It sees the bits of the texels in this
    // format: with r32ui it writes packed rgba8 texels. Errors: bad_argument (texels of another
    // size).
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
