// Memory of the device.
#pragma once

#include "decoder_glsl/gl/gl_handle.h"
#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tessera {

enum class BufferUse {
    device, // shaders and clear() write it, upload() may not: the driver keeps it where that is fast
    upload, // upload() may write it at any time
};

// A buffer of fixed size. Needs a current OpenGL 4.5 context at every call, as its destructor does.
// Offsets and sizes are bytes; ranges outside of the buffer are bad_argument and change nothing.
class GlBuffer {
public:
    // Content undefined. `name` is for messages and for debuggers. bad_argument: no bytes at all.
    // runtime: out of memory.
    static Result<GlBuffer> create(std::uint64_t bytes, BufferUse use, const std::string& name);
    // With a content that upload() cannot change.
    static Result<GlBuffer> create(std::span<const std::byte> content, const std::string& name);

    GLuint id() const { return handle_.get(); }
    std::uint64_t bytes() const { return bytes_; }

    // In order with other OpenGL calls: work issued before still sees the old content.
    Status upload(std::uint64_t offset, std::span<const std::byte> content);
    // Waits for the device. What shaders wrote is seen after
    // glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT), which this calls.
    Status read(std::uint64_t offset, std::span<std::byte> content) const;
    // Repeats `value`; offset and bytes are multiples of 4.
    Status clear(std::uint32_t value);
    Status clear(std::uint32_t value, std::uint64_t offset, std::uint64_t bytes);

    // As shader storage. The offset of a range is a multiple of
    // GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT.
    void bind_storage(GLuint binding) const;
    Status bind_storage(GLuint binding, std::uint64_t offset, std::uint64_t bytes) const;
    // Its first bytes as a uniform block.
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
