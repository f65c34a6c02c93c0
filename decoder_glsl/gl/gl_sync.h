// When the device has done something.
#pragma once

#include "decoder_glsl/gl/gl_handle.h"
#include "format/status.h"

#include <cstddef>
#include <cstdint>

namespace tessera {

// A point in the stream of commands. Needs a current context, as its destructor does.
class GlFence {
public:
    // Behind all commands so far. runtime: the driver makes none.
    static Result<GlFence> insert();

    GlFence(GlFence&& other) noexcept;
    GlFence& operator=(GlFence&& other) noexcept;
    ~GlFence();

    // Whether the device has passed it. Sends waiting commands on their way, so that polling ends.
    bool passed() const;
    // Waits for that. runtime: not within `milliseconds`, or the context is lost.
    Status wait(std::uint32_t milliseconds) const;

private:
    explicit GlFence(GLsync sync) : sync_(sync) {}
    GLsync sync_ = nullptr;
};

} // namespace tessera
