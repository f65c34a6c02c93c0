// Shader programs from source.
#pragma once

#include "decoder_glsl/gl/gl_handle.h"
#include "format/status.h"

#include <span>
#include <string>

namespace tessera {

// Every call and the destructor need a current context of OpenGL 4.3 or later.
class GlProgram {
public:
    // Compiles and links complete sources (shader_source.h). `name` is for messages and debuggers.
    // Errors: runtime (the driver refuses them; the message has its log, with the lines it names).
    static Result<GlProgram> compute(const std::string& source, const std::string& name);
    static Result<GlProgram> graphics(const std::string& vertex_source,
                                      const std::string& fragment_source, const std::string& name);

    GLuint id() const { return handle_.get(); }
    void use() const { glUseProgram(id()); }

private:
    struct Release {
        void operator()(GLuint id) const { glDeleteProgram(id); }
    };
    static Result<GlProgram> link(std::span<const GLuint> shaders, const std::string& name);

    GlHandle<Release> handle_;
};

} // namespace tessera
