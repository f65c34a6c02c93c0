#include "decoder_glsl/gl/gl_error.h"

#include <epoxy/gl.h>

namespace tessera {
namespace {

std::string error_name(GLenum code) {
    switch (code) {
    case GL_INVALID_ENUM:
        return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
        return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
        return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
        return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
        return "GL_OUT_OF_MEMORY";
    case GL_CONTEXT_LOST:
        return "GL_CONTEXT_LOST";
    default:
        return "OpenGL error " + std::to_string(code);
    }
}

} // namespace

Status take_gl_errors(const std::string& what) {
    std::string names;
    // Bounded, because a lost or missing context can report errors without end.
    for (int i = 0; i < 8; ++i) {
        const GLenum code = glGetError();
        if (code == GL_NO_ERROR)
            break;
        names += (names.empty() ? "" : ", ") + error_name(code);
    }
    return names.empty() ? Status() : Status(ErrorCode::runtime, what + ": " + names);
}

} // namespace tessera
