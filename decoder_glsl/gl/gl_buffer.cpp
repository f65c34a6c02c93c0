#include "decoder_glsl/gl/gl_buffer.h"

#include "decoder_glsl/gl/gl_error.h"

#include <limits>

namespace tessera {

Result<GlBuffer> GlBuffer::create(std::uint64_t bytes, BufferUse use, const std::string& name) {
    return create(bytes, nullptr, use == BufferUse::upload ? GL_DYNAMIC_STORAGE_BIT : 0, name);
}

Result<GlBuffer> GlBuffer::create(std::span<const std::byte> content, const std::string& name) {
    return create(content.size(), content.data(), 0, name);
}

Result<GlBuffer> GlBuffer::create(std::uint64_t bytes, const void* content, GLbitfield flags,
                                  const std::string& name) {
    const std::string what = "buffer '" + name + "' of " + std::to_string(bytes) + " bytes";
    if (bytes == 0)
        return Status(ErrorCode::bad_argument, what + ": a buffer needs at least one byte");
    if (bytes > static_cast<std::uint64_t>(std::numeric_limits<GLsizeiptr>::max()))
        return Status(ErrorCode::runtime, what + ": out of memory");
    // Errors of earlier calls must not look like errors of these.
    (void)take_gl_errors("earlier calls");
    GLuint id = 0;
    glCreateBuffers(1, &id);
    GlBuffer buffer;
    buffer.handle_ = GlHandle<Release>(id);
    glNamedBufferStorage(id, static_cast<GLsizeiptr>(bytes), content, flags);
    TESSERA_TRY(take_gl_errors(what));
    glObjectLabel(GL_BUFFER, id, -1, name.c_str());
    (void)take_gl_errors("a label that is too long does no harm");
    buffer.bytes_ = bytes;
    buffer.name_ = name;
    buffer.uploads_ = (flags & GL_DYNAMIC_STORAGE_BIT) != 0;
    return buffer;
}

Status GlBuffer::check_range(const char* what, std::uint64_t offset, std::uint64_t bytes) const {
    if (offset <= bytes_ && bytes <= bytes_ - offset)
        return {};
    return {ErrorCode::bad_argument, std::string(what) + " of " + std::to_string(bytes) +
                                         " bytes at " + std::to_string(offset) +
                                         " lies outside buffer '" + name_ + "' of " +
                                         std::to_string(bytes_) + " bytes"};
}

Status GlBuffer::upload(std::uint64_t offset, std::span<const std::byte> content) {
    TESSERA_TRY(check_range("an upload", offset, content.size()));
    if (!uploads_)
        return {ErrorCode::bad_argument, "buffer '" + name_ + "' does not allow uploads"};
    if (content.empty())
        return {};
    glNamedBufferSubData(id(), static_cast<GLintptr>(offset),
                         static_cast<GLsizeiptr>(content.size()), content.data());
    return {};
}

Status GlBuffer::read(std::uint64_t offset, std::span<std::byte> content) const {
    TESSERA_TRY(check_range("a read", offset, content.size()));
    if (content.empty())
        return {};
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    (void)take_gl_errors("earlier calls");
    glGetNamedBufferSubData(id(), static_cast<GLintptr>(offset),
                            static_cast<GLsizeiptr>(content.size()), content.data());
    return take_gl_errors("reading buffer '" + name_ + "'");
}

Status GlBuffer::clear(std::uint32_t value) {
    return clear(value, 0, bytes_);
}

Status GlBuffer::clear(std::uint32_t value, std::uint64_t offset, std::uint64_t bytes) {
    TESSERA_TRY(check_range("a clear", offset, bytes));
    if (offset % 4 != 0 || bytes % 4 != 0)
        return {ErrorCode::bad_argument,
                "buffer '" + name_ + "': a clear takes multiples of 4 bytes"};
    if (bytes != 0)
        glClearNamedBufferSubData(id(), GL_R32UI, static_cast<GLintptr>(offset),
                                  static_cast<GLsizeiptr>(bytes), GL_RED_INTEGER, GL_UNSIGNED_INT,
                                  &value);
    return {};
}

void GlBuffer::bind_storage(GLuint binding) const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, id());
}

void GlBuffer::bind_uniforms(GLuint binding, std::uint64_t bytes) const {
    glBindBufferRange(GL_UNIFORM_BUFFER, binding, id(), 0, static_cast<GLsizeiptr>(bytes));
}

} // namespace tessera
