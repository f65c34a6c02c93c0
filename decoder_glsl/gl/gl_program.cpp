#include "decoder_glsl/gl/gl_program.h"

#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/shaders/shader_log.h"

#include <limits>

namespace tessera {
namespace {

struct ReleaseShader {
    void operator()(GLuint id) const { glDeleteShader(id); }
};
using Shader = GlHandle<ReleaseShader>;

const char* stage_name(GLenum stage) {
    return stage == GL_COMPUTE_SHADER  ? "compute"
           : stage == GL_VERTEX_SHADER ? "vertex"
                                       : "fragment";
}

template <class GetLength, class GetLog>
std::string driver_log(GLuint id, GetLength get_length, GetLog get_log) {
    GLint length = 0;
    get_length(id, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(length > 0 ? length : 0), '\0');
    GLsizei written = 0;
    if (length > 0)
        get_log(id, length, &written, log.data());
    log.resize(static_cast<std::size_t>(written > 0 ? written : 0));
    return log.empty() ? "the driver gives no reason" : log;
}

Result<Shader> compile(GLenum stage, const std::string& source, const std::string& name) {
    if (source.size() > static_cast<std::size_t>(std::numeric_limits<GLint>::max()))
        return Status(ErrorCode::bad_argument, name + ": the source is too long");
    Shader shader(glCreateShader(stage));
    if (shader.get() == 0)
        return Status(ErrorCode::runtime, name + ": the driver creates no shader object");
    const char* text = source.data();
    const GLint length = static_cast<GLint>(source.size());
    glShaderSource(shader.get(), 1, &text, &length);
    glCompileShader(shader.get());
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &compiled);
    if (compiled == GL_FALSE)
        return Status(ErrorCode::runtime,
                      name + ": the " + stage_name(stage) + " shader does not compile:\n" +
                          explain_shader_log(
                              driver_log(shader.get(), glGetShaderiv, glGetShaderInfoLog), source));
    return shader;
}

} // namespace

Result<GlProgram> GlProgram::compute(const std::string& source, const std::string& name) {
    TESSERA_TRY_ASSIGN(Shader shader, compile(GL_COMPUTE_SHADER, source, name));
    const GLuint shaders[] = {shader.get()};
    return link(shaders, name);
}

Result<GlProgram> GlProgram::graphics(const std::string& vertex_source,
                                      const std::string& fragment_source, const std::string& name) {
    TESSERA_TRY_ASSIGN(Shader vertex, compile(GL_VERTEX_SHADER, vertex_source, name));
    TESSERA_TRY_ASSIGN(Shader fragment, compile(GL_FRAGMENT_SHADER, fragment_source, name));
    const GLuint shaders[] = {vertex.get(), fragment.get()};
    return link(shaders, name);
}

Result<GlProgram> GlProgram::link(std::span<const GLuint> shaders, const std::string& name) {
    const GLuint id = glCreateProgram();
    if (id == 0)
        return Status(ErrorCode::runtime, name + ": the driver creates no program object");
    GlProgram program;
    program.handle_ = GlHandle<Release>(id);
    for (const GLuint shader : shaders)
        glAttachShader(id, shader);
    glLinkProgram(id);
    for (const GLuint shader : shaders)
        glDetachShader(id, shader); // so that deleting the shaders frees them
    GLint linked = GL_FALSE;
    glGetProgramiv(id, GL_LINK_STATUS, &linked);
    if (linked == GL_FALSE)
        return Status(ErrorCode::runtime, name + ": the program does not link:\n" +
                                              driver_log(id, glGetProgramiv, glGetProgramInfoLog));
    (void)take_gl_errors("earlier calls");
    glObjectLabel(GL_PROGRAM, id, -1, name.c_str());
    (void)take_gl_errors("a label that is too long does no harm");
    return program;
}

} // namespace tessera
