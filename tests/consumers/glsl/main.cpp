// A C++ program that uses the GPU decoder. It links the functions that need OpenGL 4.5, but runs
// only those that need no device.
#include <tessera/decoder_glsl/gl_context.h>
#include <tessera/decoder_glsl/gl_view_renderer.h>
#include <tessera/decoder_glsl/shader_source.h>

#include <cstdio>

using namespace tessera;

int main(int argc, char**) {
    const Result<std::string> source = shader_source("sample.glsl", ShaderDialect::gl450, {});
    if (!source.ok() || source->find("vec4 tessera_sample(") == std::string::npos) {
        std::fprintf(stderr, "error: no sample.glsl\n");
        return 1;
    }
    if (argc > 1) { // the test gives no argument, so that it needs no device
        const auto context = HeadlessContext::create();
        std::printf("%s\n", context.ok() ? "a device" : context.status().message().c_str());
    }
    return 0;
}
