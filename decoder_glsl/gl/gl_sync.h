// Fences: points in the device's work that the host can wait for.
#pragma once

#include "decoder_glsl/gl/gl_handle.h"
#include "format/status.h"

#include <cstddef>
#include <cstdint>

namespace tessera {

// A point in the stream of OpenGL commands. Every call and the destructor need a current context.
class GlFence {
public:
    // A fence behind all commands so far. Errors: runtime (the driver creates none).
    static Result<GlFence> insert();

    GlFence(GlFence&& other) noexcept;
    GlFence& operator=(GlFence&& other) noexcept;
    ~GlFence();

    // Whether the device has passed it. Flushes waiting commands, so that polling ends.
    bool passed() const;
    // Waits until it has. Errors: runtime (not within `milliseconds`, or the context is lost).
    Status wait(std::uint32_t milliseconds) const;

private:
    explicit GlFence(GLsync sync) : sync_(sync) {}
    GLsync sync_ = nullptr;
};

} // namespace tessera
