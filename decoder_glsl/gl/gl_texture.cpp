#include "decoder_glsl/gl/gl_texture.h"

#include "decoder_glsl/gl/gl_error.h"

#include <algorithm>
#include <iterator>

namespace tessera {
namespace {

struct FormatNames {
    GLenum internal, layout, type;
    std::uint32_t bytes;
    bool integer;
};

FormatNames names_of(TexelFormat format) {
    switch (format) {
    case TexelFormat::rgba8:
        return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4, false};
    case TexelFormat::rgba16f:
        return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8, false};
    case TexelFormat::rgba32f:
        return {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16, false};
    case TexelFormat::rgba16ui:
        return {GL_RGBA16UI, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT, 8, true};
    case TexelFormat::r32ui:
        break;
    }
    return {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4, true};
}

std::int64_t limit(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}

// While it exists, uploads and reads use tightly packed rows in the caller's memory. Its destructor
// restores what the host program had set, such as another alignment or a buffer to unpack from.
class TightPacking {
public:
    TightPacking() {
        for (std::size_t i = 0; i < std::size(names); ++i) {
            glGetIntegerv(names[i], &saved_[i]);
            glPixelStorei(names[i],
                          names[i] == GL_PACK_ALIGNMENT || names[i] == GL_UNPACK_ALIGNMENT);
        }
        glGetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &pack_buffer_);
        glGetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &unpack_buffer_);
        glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
        glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    }
    TightPacking(const TightPacking&) = delete;
    TightPacking& operator=(const TightPacking&) = delete;
    ~TightPacking() {
        for (std::size_t i = 0; i < std::size(names); ++i)
            glPixelStorei(names[i], saved_[i]);
        glBindBuffer(GL_PIXEL_PACK_BUFFER, static_cast<GLuint>(pack_buffer_));
        glBindBuffer(GL_PIXEL_UNPACK_BUFFER, static_cast<GLuint>(unpack_buffer_));
    }

private:
    static constexpr GLenum names[] = {
        GL_PACK_ALIGNMENT,      GL_PACK_ROW_LENGTH,  GL_PACK_IMAGE_HEIGHT,  GL_PACK_SKIP_ROWS,
        GL_PACK_SKIP_PIXELS,    GL_PACK_SKIP_IMAGES, GL_UNPACK_ALIGNMENT,   GL_UNPACK_ROW_LENGTH,
        GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES};
    GLint saved_[std::size(names)] = {};
    GLint pack_buffer_ = 0, unpack_buffer_ = 0;
};

} // namespace

std::uint32_t texel_bytes(TexelFormat format) {
    return names_of(format).bytes;
}

Result<GlTexture> GlTexture::create(TexelFormat format, const TextureShape& shape,
                                    const std::string& name) {
    GlTexture texture;
    texture.format_ = format;
    texture.shape_ = shape;
    texture.name_ = name;
    const std::string what = "texture '" + name + "' of " + std::to_string(shape.width) + " x " +
                             std::to_string(shape.height) + " x " + std::to_string(shape.layers);
    if (shape.width == 0 || shape.height == 0 || shape.layers == 0)
        return Status(ErrorCode::bad_argument, what + ": every side must be at least 1");
    const std::int64_t side = limit(GL_MAX_TEXTURE_SIZE),
                       layers = limit(GL_MAX_ARRAY_TEXTURE_LAYERS);
    if (shape.width > side || shape.height > side || shape.layers > layers)
        return Status(ErrorCode::unsupported,
                      what + ": this device allows " + std::to_string(side) + " x " +
                          std::to_string(side) + " x " + std::to_string(layers));
    // Errors of earlier calls must not look like errors of these.
    (void)take_gl_errors("earlier calls");
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &id);
    texture.handle_ = GlHandle<Release>(id);
    glTextureStorage3D(id, 1, names_of(format).internal, static_cast<GLsizei>(shape.width),
                       static_cast<GLsizei>(shape.height), static_cast<GLsizei>(shape.layers));
    TESSERA_TRY(take_gl_errors(what + " (" + std::to_string(texture.bytes()) + " bytes)"));
    glTextureParameteri(id, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(id, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    TESSERA_TRY(texture.interpolate(false));
    glObjectLabel(GL_TEXTURE, id, -1, name.c_str());
    (void)take_gl_errors("a label that is too long does no harm");
    return texture;
}

Status GlTexture::check_layers(const char* what, std::uint32_t first, std::size_t bytes) const {
    const std::uint64_t count = bytes / layer_bytes();
    if (bytes % layer_bytes() == 0 && first <= shape_.layers && count <= shape_.layers - first)
        return {};
    return {ErrorCode::bad_argument, std::string(what) + " of " + std::to_string(bytes) +
                                         " bytes from layer " + std::to_string(first) +
                                         " on does not fit texture '" + name_ + "' with " +
                                         std::to_string(shape_.layers) + " layers of " +
                                         std::to_string(layer_bytes()) + " bytes"};
}

Status GlTexture::upload(std::uint32_t first, std::span<const std::byte> layers) {
    TESSERA_TRY(check_layers("an upload", first, layers.size()));
    if (layers.empty())
        return {};
    const TightPacking packing;
    const FormatNames names = names_of(format_);
    glTextureSubImage3D(id(), 0, 0, 0, static_cast<GLint>(first),
                        static_cast<GLsizei>(shape_.width), static_cast<GLsizei>(shape_.height),
                        static_cast<GLsizei>(layers.size() / layer_bytes()), names.layout,
                        names.type, layers.data());
    return {};
}

Status GlTexture::read(std::uint32_t first, std::span<std::byte> layers) const {
    TESSERA_TRY(check_layers("a read", first, layers.size()));
    if (layers.empty())
        return {};
    const TightPacking packing;
    const FormatNames names = names_of(format_);
    const std::uint64_t count = layers.size() / layer_bytes();
    (void)take_gl_errors("earlier calls");
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    // OpenGL takes the size of the destination as an int, so large textures are read in parts of 1
    // GiB.
    const std::uint64_t step = std::max<std::uint64_t>(1, (1u << 30) / layer_bytes());
    for (std::uint64_t done = 0; done < count; done += step) {
        const std::uint64_t now = std::min(step, count - done);
        glGetTextureSubImage(id(), 0, 0, 0, static_cast<GLint>(first + done),
                             static_cast<GLsizei>(shape_.width),
                             static_cast<GLsizei>(shape_.height), static_cast<GLsizei>(now),
                             names.layout, names.type, static_cast<GLsizei>(now * layer_bytes()),
                             layers.data() + done * layer_bytes());
    }
    return take_gl_errors("reading texture '" + name_ + "'");
}

void GlTexture::clear() {
    const FormatNames names = names_of(format_);
    glClearTexImage(id(), 0, names.layout, names.type, nullptr);
}

Status GlTexture::clear(std::span<const std::byte> texel) {
    if (texel.size() != texel_bytes(format_))
        return {ErrorCode::bad_argument, "texture '" + name_ + "': a texel has " +
                                             std::to_string(texel_bytes(format_)) + " bytes, not " +
                                             std::to_string(texel.size())};
    const FormatNames names = names_of(format_);
    glClearTexImage(id(), 0, names.layout, names.type, texel.data());
    return {};
}

Status GlTexture::interpolate(bool linear) {
    if (linear && names_of(format_).integer)
        return {ErrorCode::bad_argument,
                "texture '" + name_ + "' holds integers, which are not interpolated"};
    const GLint filter = linear ? GL_LINEAR : GL_NEAREST;
    glTextureParameteri(id(), GL_TEXTURE_MIN_FILTER, filter);
    glTextureParameteri(id(), GL_TEXTURE_MAG_FILTER, filter);
    return {};
}

void GlTexture::bind_texture(GLuint unit) const {
    glBindTextureUnit(unit, id());
}

Status GlTexture::bind_image(GLuint unit, GLenum access, TexelFormat as) const {
    if (texel_bytes(as) != texel_bytes(format_))
        return {ErrorCode::bad_argument,
                "texture '" + name_ + "' cannot be bound with texels of another size"};
    glBindImageTexture(unit, id(), 0, GL_TRUE, 0, access, names_of(as).internal);
    return {};
}

} // namespace tessera
