#include "decoder_glsl/gl/gl_sync.h"

#include "decoder_glsl/gl/gl_error.h"

#include <string>
#include <utility>

namespace tessera {

Result<GlFence> GlFence::insert() {
    const GLsync sync = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (sync == nullptr)
        return Status(ErrorCode::runtime, "the driver creates no fence");
    return GlFence(sync);
}

GlFence::GlFence(GlFence&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}

GlFence& GlFence::operator=(GlFence&& other) noexcept {
    std::swap(sync_, other.sync_);
    return *this;
}

GlFence::~GlFence() {
    if (sync_ != nullptr)
        glDeleteSync(sync_);
}

bool GlFence::passed() const {
    const GLenum state = glClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, 0);
    return state == GL_ALREADY_SIGNALED || state == GL_CONDITION_SATISFIED;
}

Status GlFence::wait(std::uint32_t milliseconds) const {
    const GLenum state =
        glClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, GLuint64{milliseconds} * 1000000);
    if (state == GL_ALREADY_SIGNALED || state == GL_CONDITION_SATISFIED)
        return {};
    if (state == GL_TIMEOUT_EXPIRED)
        return {ErrorCode::runtime,
                "the device did not finish within " + std::to_string(milliseconds) + " ms"};
    return {ErrorCode::runtime, "waiting for the device failed"};
}

} // namespace tessera
