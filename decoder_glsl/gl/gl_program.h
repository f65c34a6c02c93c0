// Shader programs from source.
#pragma once

#include "decoder_glsl/gl/gl_handle.h"
#include "format/status.h"

#include <span>
#include <string>

namespace tessera {

// Needs a current context with OpenGL 4.3 or later at every call, as its destructor does.
class GlProgram {
public:
    // From complete sources (shader_source.h). runtime: the driver refuses them; the message holds
    // the driver's log with the lines that it complains of. `name` is for messages and debuggers.
    static Result<GlProgram> compute(const std::string& source, const std::string& name);
    static Result<GlProgram> graphics(const std::string& vertex_source,
                                      const std::string& fragment_source, const std::string& name);

    GLuint id() const { return handle_.get(); }
    void use() const { glUseProgram(id()); }
    // For glUniform*; -1 when the program has no such uniform, or optimised it away.
    GLint uniform(const char* name) const { return glGetUniformLocation(id(), name); }

private:
    struct Release {
        void operator()(GLuint id) const { glDeleteProgram(id); }
    };
    static Result<GlProgram> link(std::span<const GLuint> shaders, const std::string& name);

    GlHandle<Release> handle_;
};

} // namespace tessera
