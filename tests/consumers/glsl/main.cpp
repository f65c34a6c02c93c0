// A program in C++ that uses the GPU's side of Tessera: what a device with OpenGL 4.5 is needed for is
// linked, and what needs none is run.
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
    if (argc > 1) { // a device is not asked for by the test
        const auto context = HeadlessContext::create();
        std::printf("%s\n", context.ok() ? "a device" : context.status().message().c_str());
    }
    return 0;
}
