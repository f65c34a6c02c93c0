// Buffers of the device.
#pragma once

#include "decoder_glsl/gl/gl_handle.h"
#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tessera {

enum class BufferUse {
    device, // only shaders and clear() write it, so the driver can keep it in fast memory
    upload, // upload() may write it at any time
};

// A buffer of fixed size. Every call and the destructor need a current OpenGL 4.5 context. Offsets
// and sizes are bytes. A range outside the buffer is bad_argument and changes nothing.
class GlBuffer {
public:
    // A buffer of undefined content. `name` is for messages and debuggers. Errors: bad_argument (0
    // bytes), runtime (out of memory).
    static Result<GlBuffer> create(std::uint64_t bytes, BufferUse use, const std::string& name);
    // A buffer of this content, which upload() cannot change.
    static Result<GlBuffer> create(std::span<const std::byte> content, const std::string& name);

    GLuint id() const { return handle_.get(); }
    std::uint64_t bytes() const { return bytes_; }

    // Takes its turn among the OpenGL calls: work that was issued earlier sees the old content.
    Status upload(std::uint64_t offset, std::span<const std::byte> content);
    // Waits for the device, and calls glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT) to see what
    // shaders wrote.
    Status read(std::uint64_t offset, std::span<std::byte> content) const;
    // Fills the buffer, or a range of it, with `value`. offset and bytes are multiples of 4.
    Status clear(std::uint32_t value);
    Status clear(std::uint32_t value, std::uint64_t offset, std::uint64_t bytes);

    // Binds it as shader storage.
    void bind_storage(GLuint binding) const;
    // Binds its first bytes as a uniform block.
    void bind_uniforms(GLuint binding, std::uint64_t bytes) const;

private:
    struct Release {
        void operator()(GLuint id) const { glDeleteBuffers(1, &id); }
    };
    static Result<GlBuffer> create(std::uint64_t bytes, const void* content, GLbitfield flags,
                                   const std::string& name);
    Status check_range(const char* what, std::uint64_t offset, std::uint64_t bytes) const;

    GlHandle<Release> handle_;
    std::uint64_t bytes_ = 0;
    std::string name_;
    bool uploads_ = false;
};

} // namespace tessera
