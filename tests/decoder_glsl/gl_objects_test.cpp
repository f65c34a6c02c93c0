// Buffers, textures, programs, fences and timers on the device.
#include "decoder_glsl/draw/gl_raster_state.h"
#include "decoder_glsl/gl/gl_buffer.h"
#include "decoder_glsl/gl/gl_device.h"
#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/gl/gl_program.h"
#include "decoder_glsl/gl/gl_sync.h"
#include "decoder_glsl/gl/gl_texture.h"
#include "decoder_glsl/shader_source.h"
#include "decoder_glsl/shaders/shader_files.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/shader_programs.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

namespace tessera::test {
namespace {

using Words = std::vector<std::uint32_t>;

class Gl : public GpuTest {
protected:
    void TearDown() override {
        if (context_) {
            const Status status = take_gl_errors("left over");
            EXPECT_TRUE(status) << status.message();
        }
    }
};

std::span<const std::byte> bytes_of(const Words& words) {
    return std::as_bytes(std::span(words));
}

Words counted(std::size_t count, std::uint32_t first = 0) {
    Words words(count);
    std::iota(words.begin(), words.end(), first);
    return words;
}

Words read_words(const GlBuffer& buffer) {
    Words words(buffer.bytes() / 4);
    const Status status = buffer.read(0, std::as_writable_bytes(std::span(words)));
    EXPECT_TRUE(status) << status.message();
    return words;
}

template <class T> T take(Result<T> result) {
    if (!result) {
        ADD_FAILURE() << result.status().message();
        std::abort();
    }
    return std::move(*result);
}

GlProgram copy_words() {
    const ShaderFile files[] = {{"copy_words.comp.glsl", R"glsl(
layout(local_size_x = 128) in;
layout(std430, binding = 0) readonly buffer Source { uint source_words[]; };
layout(std430, binding = 1) writeonly buffer Target { uint target_words[]; };
void main() {
    uint words = min(uint(source_words.length()), uint(target_words.length()));
    uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint i = gl_GlobalInvocationID.x; i < words; i += stride)
        target_words[i] = source_words[i];
}
)glsl"}};
    const auto source = shader_source(files, "copy_words.comp.glsl", ShaderDialect::gl450);
    EXPECT_TRUE(source) << source.status().message();
    return take(GlProgram::compute(*source, "copy_words"));
}

TEST_F(Gl, ContextDescribesItsDevice) {
    std::printf("%s | %s | %s%s\n", context_->vendor().c_str(), context_->device().c_str(),
                context_->version().c_str(), context_->is_software() ? " | software" : "");
    EXPECT_FALSE(context_->vendor().empty());
    EXPECT_FALSE(context_->device().empty());
    EXPECT_GE(current_limits().version, 45);
    const Status status = check_device();
    EXPECT_TRUE(status) << status.message();
}

TEST_F(Gl, ContextsAreIndependent) {
    const Words words = counted(8);
    GlBuffer buffer = take(GlBuffer::create(bytes_of(words), "first"));
    {
        auto second = HeadlessContext::create(); // becomes current on this thread
        ASSERT_TRUE(second) << second.status().message();
        HeadlessContext moved = std::move(*second);
        const GlBuffer other = take(GlBuffer::create(bytes_of(counted(8, 50)), "second"));
        ASSERT_TRUE(context_->make_current());
        EXPECT_EQ(read_words(buffer), words);
        ASSERT_TRUE(moved.make_current());
        EXPECT_EQ(read_words(other), counted(8, 50));
    } // destroying it must leave the first one's display open
    ASSERT_TRUE(context_->make_current());
    EXPECT_EQ(read_words(buffer), words);
}

TEST_F(Gl, ContextOfAnotherThreadIsRefused) {
    Status status;
    std::thread([&] { status = context_->make_current(); }).join();
    EXPECT_EQ(status.code(), ErrorCode::runtime);
    EXPECT_TRUE(context_->make_current());
}

TEST_F(Gl, BufferRoundTrip) {
    GlBuffer buffer = take(GlBuffer::create(64, BufferUse::upload, "words"));
    EXPECT_EQ(buffer.bytes(), 64u);
    ASSERT_TRUE(buffer.clear(7));
    EXPECT_EQ(read_words(buffer), Words(16, 7));
    ASSERT_TRUE(buffer.upload(8, bytes_of({1, 2, 3})));
    ASSERT_TRUE(buffer.clear(9, 56, 8));
    ASSERT_TRUE(buffer.upload(64, {}));
    EXPECT_EQ(read_words(buffer), (Words{7, 7, 1, 2, 3, 7, 7, 7, 7, 7, 7, 7, 7, 7, 9, 9}));
    Words part(2);
    ASSERT_TRUE(buffer.read(12, std::as_writable_bytes(std::span(part))));
    EXPECT_EQ(part, (Words{2, 3}));

    GlBuffer moved = std::move(buffer);
    EXPECT_EQ(read_words(moved)[2], 1u);
    moved = take(GlBuffer::create(bytes_of({5}), "other"));
    EXPECT_EQ(read_words(moved), Words{5});
}

TEST_F(Gl, BufferErrors) {
    EXPECT_EQ(GlBuffer::create(0, BufferUse::device, "x").status().code(), ErrorCode::bad_argument);
    for (const std::uint64_t bytes : {std::uint64_t{1} << 46, ~std::uint64_t{0}}) {
        const auto huge = GlBuffer::create(bytes, BufferUse::device, "huge");
        EXPECT_EQ(huge.status().code(), ErrorCode::runtime);
        EXPECT_NE(huge.status().message().find(std::to_string(bytes) + " bytes"), std::string::npos)
            << huge.status().message();
    }
    GlBuffer fixed = take(GlBuffer::create(bytes_of(counted(4)), "fixed"));
    EXPECT_EQ(fixed.upload(0, bytes_of({1})).code(), ErrorCode::bad_argument);
    GlBuffer buffer = take(GlBuffer::create(16, BufferUse::upload, "small"));
    EXPECT_EQ(buffer.upload(4, bytes_of(counted(4))).code(), ErrorCode::bad_argument);
    EXPECT_EQ(buffer.upload(17, {}).code(), ErrorCode::bad_argument);
    EXPECT_EQ(buffer.upload(~std::uint64_t{0}, bytes_of({1})).code(), ErrorCode::bad_argument);
    Words words(5);
    EXPECT_EQ(buffer.read(0, std::as_writable_bytes(std::span(words))).code(),
              ErrorCode::bad_argument);
    EXPECT_EQ(buffer.clear(0, 2, 4).code(), ErrorCode::bad_argument);
    EXPECT_EQ(buffer.clear(0, 12, 8).code(), ErrorCode::bad_argument);
}

TEST_F(Gl, ComputeCopiesWords) {
    const GlProgram program = copy_words();
    const Words words = counted(1000, 0xfffffe00u);
    const GlBuffer source = take(GlBuffer::create(bytes_of(words), "source"));
    GlBuffer target = take(GlBuffer::create(4 * 1003, BufferUse::device, "target"));
    ASSERT_TRUE(target.clear(77));
    program.use();
    source.bind_storage(0);
    target.bind_storage(1);
    glDispatchCompute(2, 1, 1);
    Words want = words;
    want.resize(1003, 77);
    EXPECT_EQ(read_words(target), want);
}

TEST_F(Gl, ProgramErrorsShowTheLine) {
    const auto bad = GlProgram::compute("#version 450 core\nlayout(local_size_x = 1) in;\n"
                                        "void main() {\n    uint x = nothing;\n}\n",
                                        "bad");
    EXPECT_EQ(bad.status().code(), ErrorCode::runtime);
    EXPECT_EQ(bad.status().message().find("bad: the compute shader does not compile:\n"), 0u);
    EXPECT_NE(bad.status().message().find("4 |     uint x = nothing;"), std::string::npos)
        << bad.status().message();

    const ShaderFile files[] = {
        {"a.comp.glsl",
         "layout(local_size_x = 1) in;\n#include \"b.glsl\"\nvoid main() { f(); }\n"},
        {"b.glsl", "void f() {\n    uint y = 1.5 +;\n}\n"}};
    const auto source = shader_source(files, "a.comp.glsl", ShaderDialect::gl450);
    ASSERT_TRUE(source);
    const auto included = GlProgram::compute(*source, "a");
    EXPECT_NE(included.status().message().find("b.glsl:2 |     uint y = 1.5 +;"), std::string::npos)
        << included.status().message();

    const auto unlinked = GlProgram::graphics(
        "#version 450 core\nout vec2 place;\nvoid main() { place = vec2(0); gl_Position = vec4(0); "
        "}\n",
        "#version 450 core\nin vec4 place;\nout vec4 colour;\nvoid main() { colour = place; }\n",
        "pair");
    EXPECT_EQ(unlinked.status().code(), ErrorCode::runtime);
    EXPECT_EQ(unlinked.status().message().find("pair: the program does not link:\n"), 0u)
        << unlinked.status().message();
    const auto vertex = GlProgram::graphics("#version 450 core\nvoid main() { x }\n",
                                            "#version 450 core\nvoid main() {}\n", "pair");
    EXPECT_EQ(vertex.status().message().find("pair: the vertex shader does not compile:\n"), 0u);
}

TEST_F(Gl, GraphicsProgramAndUniforms) {
    const GlProgram program = take(GlProgram::graphics(
        "#version 450 core\nvoid main() { gl_Position = vec4(gl_VertexID & 1, 0, 0, 1); }\n",
        "#version 450 core\nuniform vec4 tint;\nout vec4 colour;\nvoid main() { colour = tint; }\n",
        "tinted"));
    EXPECT_GE(glGetUniformLocation(program.id(), "tint"), 0);
    EXPECT_EQ(glGetUniformLocation(program.id(), "nothing"), -1);
}

TEST_F(Gl, TextureRoundTrip) {
    for (const TexelFormat format :
         {TexelFormat::rgba8, TexelFormat::rgba16f, TexelFormat::rgba16ui, TexelFormat::r32ui}) {
        const TextureShape shape{3, 5, 4};
        GlTexture texture = take(GlTexture::create(format, shape, "cache"));
        EXPECT_EQ(texture.layer_bytes(), 15u * texel_bytes(format));
        EXPECT_EQ(texture.bytes(), 60u * texel_bytes(format));
        texture.clear();
        std::vector<std::byte> all(texture.bytes(), std::byte{1}),
            layers(2 * texture.layer_bytes());
        ASSERT_TRUE(texture.read(0, all));
        EXPECT_EQ(all, std::vector<std::byte>(texture.bytes()));
        for (std::size_t i = 0; i < layers.size(); ++i)
            layers[i] = static_cast<std::byte>(i % 100); // no NaN as half floats
        glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
        glPixelStorei(GL_PACK_ROW_LENGTH, 100);
        ASSERT_TRUE(texture.upload(1, layers));
        std::vector<std::byte> got(layers.size());
        ASSERT_TRUE(texture.read(1, got));
        GLint kept[2];
        glGetIntegerv(GL_UNPACK_ALIGNMENT, &kept[0]);
        glGetIntegerv(GL_PACK_ROW_LENGTH, &kept[1]);
        EXPECT_EQ(kept[0], 8);
        EXPECT_EQ(kept[1], 100);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        glPixelStorei(GL_PACK_ROW_LENGTH, 0);
        EXPECT_EQ(got, layers);
        ASSERT_TRUE(texture.read(0, all));
        std::vector<std::byte> want(texture.bytes());
        std::copy(layers.begin(), layers.end(),
                  want.begin() + static_cast<std::ptrdiff_t>(texture.layer_bytes()));
        EXPECT_EQ(all, want);

        EXPECT_EQ(texture.upload(3, layers).code(), ErrorCode::bad_argument);
        EXPECT_EQ(texture.upload(0, std::span(layers).first(7)).code(), ErrorCode::bad_argument);
        EXPECT_EQ(texture.read(5, {}).code(), ErrorCode::bad_argument);
        EXPECT_EQ(texture.read(4, got).code(), ErrorCode::bad_argument);
        const bool integers = format != TexelFormat::rgba8 && format != TexelFormat::rgba16f;
        EXPECT_EQ(texture.interpolate(true).ok(), !integers);
    }
}

// All that the rasteriser's state changes, as the device reports it.
std::vector<GLint> raster_state() {
    std::vector<GLint> state;
    for (const GLenum name :
         {GL_DEPTH_TEST, GL_CULL_FACE, GL_MULTISAMPLE, GL_BLEND, GL_FRAMEBUFFER_SRGB,
          GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_DEPTH_CLAMP, GL_POLYGON_OFFSET_FILL})
        state.push_back(glIsEnabled(name));
    for (const GLenum name :
         {GL_CULL_FACE_MODE, GL_FRONT_FACE, GL_DEPTH_FUNC, GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB,
          GL_BLEND_SRC_ALPHA, GL_BLEND_DST_ALPHA, GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA,
          GL_DEPTH_WRITEMASK, GL_COLOR_WRITEMASK, GL_VIEWPORT, GL_CLIP_ORIGIN, GL_CLIP_DEPTH_MODE,
          GL_DRAW_FRAMEBUFFER_BINDING}) {
        GLint values[4] = {};
        glGetIntegerv(name, values);
        state.insert(state.end(), values, values + 4);
    }
    return state;
}

TEST_F(Gl, DrawingRestoresTheStateOfTheRasteriser) {
    const std::vector<GLint> usual = raster_state();
    GLint viewport[4];
    glGetIntegerv(GL_VIEWPORT, viewport);
    glEnable(GL_BLEND);
    glEnable(GL_SCISSOR_TEST);
    glDisable(GL_MULTISAMPLE);
    glBlendFuncSeparate(GL_DST_COLOR, GL_ONE, GL_ZERO, GL_SRC_ALPHA);
    glBlendEquationSeparate(GL_MAX, GL_FUNC_REVERSE_SUBTRACT);
    glDepthFunc(GL_NOTEQUAL);
    glDepthMask(GL_FALSE);
    glColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
    glFrontFace(GL_CW);
    glViewport(1, 2, 3, 4);
    const std::vector<GLint> before = raster_state();
    {
        GlRasterState state(0, 8, 8);
        EXPECT_NE(raster_state(), before);
        state.write_depths();
        state.write_colours();
        state.blend_colours();
        state.write_linear(true);
    }
    EXPECT_EQ(raster_state(), before);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    glEnable(GL_MULTISAMPLE);
    glBlendFunc(GL_ONE, GL_ZERO);
    glBlendEquation(GL_FUNC_ADD);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glFrontFace(GL_CCW);
    glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
    EXPECT_EQ(raster_state(), usual);
}

TEST_F(Gl, TextureErrors) {
    EXPECT_EQ(GlTexture::create(TexelFormat::rgba8, {0, 1, 1}, "x").status().code(),
              ErrorCode::bad_argument);
    EXPECT_EQ(GlTexture::create(TexelFormat::rgba8, {1u << 20, 1, 1}, "x").status().code(),
              ErrorCode::unsupported);
    EXPECT_EQ(GlTexture::create(TexelFormat::rgba8, {1, 1, 1u << 31}, "x").status().code(),
              ErrorCode::unsupported);
}

TEST_F(Gl, ImagesAreWrittenByComputeAndSampled) {
    const GlProgram fill = take(
        GlProgram::compute("#version 450 core\nlayout(local_size_x = 4, local_size_y = 4) in;\n"
                           "layout(rgba8, binding = 0) uniform writeonly image2DArray cache;\n"
                           "void main() {\n"
                           "    ivec3 at = ivec3(gl_GlobalInvocationID);\n"
                           "    imageStore(cache, at, vec4(at, 255) / 255.0);\n}\n",
                           "fill"));
    const GlProgram sample =
        take(GlProgram::compute("#version 450 core\nlayout(local_size_x = 1) in;\n"
                                "layout(binding = 3) uniform sampler2DArray cache;\n"
                                "layout(std430, binding = 0) buffer Found { uint found[]; };\n"
                                "void main() {\n"
                                "    found[0] = packUnorm4x8(textureLod(cache, vec3(2.5, 1.5, 0) / "
                                "vec3(8, 4, 1) + vec3(0, 0, 1), 0.0));\n}\n",
                                "sample"));
    GlTexture texture = take(GlTexture::create(TexelFormat::rgba8, {8, 4, 2}, "cache"));
    fill.use();
    ASSERT_TRUE(texture.bind_image(0, GL_WRITE_ONLY, TexelFormat::rgba8));
    glDispatchCompute(2, 1, 2);
    std::vector<std::uint8_t> texels(texture.bytes());
    ASSERT_TRUE(texture.read(0, std::as_writable_bytes(std::span(texels))));
    for (int i = 0; i < 64; ++i) {
        const std::uint8_t* texel = &texels[static_cast<std::size_t>(4 * i)];
        EXPECT_EQ(texel[0], i % 8);
        EXPECT_EQ(texel[1], i / 8 % 4);
        EXPECT_EQ(texel[2], i / 32);
        EXPECT_EQ(texel[3], 255);
    }
    const GlBuffer found = take(GlBuffer::create(4, BufferUse::device, "found"));
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    sample.use();
    found.bind_storage(0);
    texture.bind_texture(3);
    glDispatchCompute(1, 1, 1);
    EXPECT_EQ(read_words(found), Words{0xff010102u});
}

// The decoder stores the bits of texels, which are later sampled as numbers.
TEST_F(Gl, ImagesAreWrittenAsBits) {
    struct Case {
        TexelFormat format, as;
        const char *layout, *value;
        std::vector<std::uint8_t> texel;
    };
    const Case cases[] = {
        {TexelFormat::rgba8, TexelFormat::r32ui, "r32ui", "uvec4(0x04030201u)", {1, 2, 3, 4}},
        {TexelFormat::rgba16f,
         TexelFormat::rgba16ui,
         "rgba16ui",
         "uvec4(0x3c00u, 1u, 0xc000u, 5u)",
         {0, 0x3c, 1, 0, 0, 0xc0, 5, 0}}};
    for (const Case& c : cases) {
        const GlProgram store = take(GlProgram::compute(
            "#version 450 core\nlayout(local_size_x = 1) in;\nlayout(" + std::string(c.layout) +
                ", binding = 0) uniform writeonly uimage2DArray cache;\n"
                "void main() { imageStore(cache, ivec3(gl_WorkGroupID), " +
                c.value + "); }\n",
            "store"));
        const GlTexture texture = take(GlTexture::create(c.format, {2, 2, 3}, "cache"));
        store.use();
        ASSERT_TRUE(texture.bind_image(0, GL_WRITE_ONLY, c.as));
        glDispatchCompute(2, 2, 3);
        std::vector<std::uint8_t> texels(texture.bytes());
        ASSERT_TRUE(texture.read(0, std::as_writable_bytes(std::span(texels))));
        for (std::size_t i = 0; i < texels.size(); ++i)
            ASSERT_EQ(texels[i], c.texel[i % c.texel.size()]) << c.layout << " byte " << i;
        EXPECT_EQ(
            texture
                .bind_image(0, GL_WRITE_ONLY,
                            texel_bytes(c.format) == 4 ? TexelFormat::rgba16f : TexelFormat::rgba8)
                .code(),
            ErrorCode::bad_argument);
    }
}

TEST_F(Gl, FencesPass) {
    const GlBuffer buffer = take(GlBuffer::create(1 << 20, BufferUse::device, "work"));
    GlFence fence = take(GlFence::insert());
    const Status status = fence.wait(10000);
    EXPECT_TRUE(status) << status.message();
    EXPECT_TRUE(fence.passed());
    GlFence moved = std::move(fence);
    EXPECT_TRUE(moved.passed());
    moved = take(GlFence::insert());
    EXPECT_TRUE(moved.wait(10000));
}

// OpenGL 4.5 accepts ES 3.1 shaders, too.
TEST_F(Gl, DriverCompilesEveryProgram) {
    const auto programs = shader_programs();
    ASSERT_FALSE(programs.empty());
    for (const ShaderDialect dialect : {ShaderDialect::gl450, ShaderDialect::es310})
        for (const ShaderProgram& program : programs) {
            SCOPED_TRACE(program.label() + (dialect == ShaderDialect::es310 ? ", ES" : ""));
            const auto source = shader_source(program.name, dialect, program.defines);
            ASSERT_TRUE(source) << source.status().message();
            if (program.stage == "comp") {
                const auto compiled = GlProgram::compute(*source, program.name);
                EXPECT_TRUE(compiled) << compiled.status().message();
            } else if (program.stage == "frag") {
                // Layers are fragments of the mesh's own program.
                const std::string stem = program.stem == "layered_mesh" ? "mesh" : program.stem;
                const auto vertex = shader_source(stem + ".vert.glsl", dialect, program.defines);
                ASSERT_TRUE(vertex) << vertex.status().message();
                const auto compiled = GlProgram::graphics(*vertex, *source, program.stem);
                EXPECT_TRUE(compiled) << compiled.status().message();
            }
        }
}

// Creates a context in a new process with `variable` in its environment, and expects the error, or
// the version if there is none, to match `pattern`.
void expect_outcome(const char* variable, const char* value, const char* pattern) {
    GTEST_FLAG_SET(death_test_style, "threadsafe"); // this process may already have loaded a driver
    EXPECT_EXIT(
        {
            setenv(variable, value, 1);
            const auto context = HeadlessContext::create();
            const bool named = context || context.status().code() == ErrorCode::unsupported;
            std::fputs(context ? context->version().c_str() : context.status().message().c_str(),
                       stderr);
            std::_Exit(named ? 0 : 1);
        },
        testing::ExitedWithCode(0), pattern);
}

TEST(GlMissing, OldDrivers) {
    if (no_gpu_asked())
        GTEST_SKIP() << "TESSERA_NO_GPU=1";
    // Only Mesa can report another version.
    expect_outcome("MESA_GL_VERSION_OVERRIDE", "3.3",
                   "OpenGL 4.5 is needed, this device offers 3.3|NVIDIA");
}

TEST(GlMissing, NoDriver) {
    expect_outcome("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere.json", "no EGL");
}

} // namespace
} // namespace tessera::test
