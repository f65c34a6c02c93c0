#include "decoder_glsl/draw/gl_picture.h"

#include "decoder_glsl/gl/gl_error.h"
#include "format/samples.h"

namespace tessera {
namespace {

constexpr GLsizei samples = 4;
constexpr std::uint64_t sample_bytes_held = 8 + 4; // colour and depth

GLuint new_samples(GLenum format, std::uint32_t width, std::uint32_t height) {
    GLuint id = 0;
    glCreateRenderbuffers(1, &id);
    glNamedRenderbufferStorageMultisample(id, samples, format, static_cast<GLsizei>(width),
                                          static_cast<GLsizei>(height));
    return id;
}

GLuint new_framebuffer() {
    GLuint id = 0;
    glCreateFramebuffers(1, &id);
    return id;
}

bool is_complete(GLuint framebuffer) {
    return glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

} // namespace

Result<GlPicture> GlPicture::create(std::uint32_t width, std::uint32_t height, bool is_srgb) {
    GlPicture p;
    TESSERA_TRY_ASSIGN(p.mean_,
                       GlTexture::create(TexelFormat::rgba16f, {width, height, 1}, "picture"));
    p.colours_ = GlHandle<ReleaseRenderbuffer>(
        new_samples(is_srgb ? GL_SRGB8_ALPHA8 : GL_RGBA16F, width, height));
    p.depths_ = GlHandle<ReleaseRenderbuffer>(new_samples(GL_DEPTH_COMPONENT32F, width, height));
    const std::string what =
        "a picture of " + std::to_string(width) + " x " + std::to_string(height);
    TESSERA_TRY(take_gl_errors(what));
    p.samples_ = GlHandle<ReleaseFramebuffer>(new_framebuffer());
    p.means_ = GlHandle<ReleaseFramebuffer>(new_framebuffer());
    const GLuint in = p.samples_.get(), out = p.means_.get();
    glNamedFramebufferRenderbuffer(in, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, p.colours_.get());
    glNamedFramebufferRenderbuffer(in, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, p.depths_.get());
    glNamedFramebufferTextureLayer(out, GL_COLOR_ATTACHMENT0, p.mean_.id(), 0, 0);
    if (!is_complete(in) || !is_complete(out))
        return Status(ErrorCode::unsupported,
                      what + ": this device does not draw into such a picture");
    return p;
}

void GlPicture::clear(const std::array<float, 4>& colour) {
    const float farthest = 0;
    glClearNamedFramebufferfv(samples_.get(), GL_COLOR, 0, colour.data());
    glClearNamedFramebufferfv(samples_.get(), GL_DEPTH, 0, &farthest);
}

void GlPicture::resolve() {
    const auto right = static_cast<GLint>(width()), bottom = static_cast<GLint>(height());
    glBlitNamedFramebuffer(samples_.get(), means_.get(), 0, 0, right, bottom, 0, 0, right, bottom,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

Result<std::vector<float>> GlPicture::read() const {
    std::vector<std::uint16_t> halves(std::size_t{width()} * height() * 4);
    TESSERA_TRY(mean_.read(0, std::as_writable_bytes(std::span(halves))));
    std::vector<float> pixels;
    pixels.reserve(halves.size());
    for (const std::uint16_t half : halves)
        pixels.push_back(half_to_float(half));
    return pixels;
}

std::uint64_t GlPicture::bytes() const {
    return mean_.bytes() + std::uint64_t{width()} * height() * samples * sample_bytes_held;
}

} // namespace tessera
