// Tests shader sources (heads, includes, errors), and checks every program against the GLSL
// specification.
#include "decoder_glsl/shader_source.h"
#include "decoder_glsl/shaders/shader_files.h"
#include "decoder_glsl/shaders/shader_log.h"
#include "tests/support/shader_programs.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <vector>

namespace tessera::test {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++n;
    return n;
}

std::string error_of(std::span<const ShaderFile> files, std::string_view name,
                     std::span<const ShaderDefine> defines = {}) {
    const auto source = shader_source(files, name, ShaderDialect::gl450, defines);
    EXPECT_FALSE(source);
    EXPECT_EQ(source.status().code(), ErrorCode::bad_argument);
    return source.status().message();
}

TEST(ShaderSource, HeadOfEachDialect) {
    const ShaderFile files[] = {{"a.glsl", "void main() {}\n"}};
    const ShaderDefine defines[] = {{"GROUP", "64"}, {"EMPTY", ""}};
    const auto gl = shader_source(files, "a.glsl", ShaderDialect::gl450, defines);
    ASSERT_TRUE(gl);
    EXPECT_EQ(*gl, "#version 450 core\n#define TSR_GL450 1\n#define GROUP 64\n#define EMPTY \n"
                   "// source 1: a.glsl\n#line 1 1\nvoid main() {}\n");
    const auto es = shader_source(files, "a.glsl", ShaderDialect::es310, defines);
    ASSERT_TRUE(es);
    EXPECT_TRUE(es->starts_with("#version 310 es\n#define TSR_ES310 1\n"));
    for (const char* type : {"float", "int", "sampler2DArray", "usampler2DArray", "image2DArray",
                             "uimage2DArray", "usampler2D"})
        EXPECT_EQ(count(*es, std::string("precision highp ") + type + ";\n"), 1u) << type;
    EXPECT_EQ(count(*es, "#define GROUP 64\n"), 1u);
    const auto vulkan = shader_source(files, "a.glsl", ShaderDialect::vulkan);
    ASSERT_TRUE(vulkan);
    EXPECT_TRUE(vulkan->starts_with("#version 450\n#define TSR_VULKAN 1\n"));
}

TEST(ShaderSource, IncludesAreExpandedOnceWithLineNumbers) {
    const ShaderFile files[] = {
        {"main.comp.glsl", "first\n  # include \"b.glsl\" // why\n#include \"c.glsl\"\nlast"},
        {"b.glsl", "#include \"c.glsl\"\r\nb\r\n"},
        {"c.glsl", "c\n"}};
    const auto source = shader_source(files, "main.comp.glsl", ShaderDialect::gl450);
    ASSERT_TRUE(source) << source.status().message();
    EXPECT_EQ(*source, "#version 450 core\n#define TSR_GL450 1\n"
                       "// source 1: main.comp.glsl\n#line 1 1\nfirst\n"
                       "// source 2: b.glsl\n#line 1 2\n"
                       "// source 3: c.glsl\n#line 1 3\nc\n"
                       "#line 2 2\nb\n"
                       "#line 3 1\n"
                       "#line 4 1\nlast\n");
}

TEST(ShaderSource, TextThatResemblesDirectivesStays) {
    const ShaderFile files[] = {{"a.glsl", "int include;\n#includes\n// #include \"x\"\n"}};
    const auto source = shader_source(files, "a.glsl", ShaderDialect::gl450);
    ASSERT_TRUE(source);
    EXPECT_EQ(count(*source, "int include;\n#includes\n// #include \"x\"\n"), 1u);
}

TEST(ShaderSource, ErrorsNameFileAndLine) {
    const ShaderFile files[] = {{"unknown.glsl", "\n#include \"nowhere.glsl\"\n"},
                                {"a.glsl", "#include \"b.glsl\"\n"},
                                {"b.glsl", "x\n#include \"a.glsl\"\n"},
                                {"self.glsl", "#include \"self.glsl\"\n"},
                                {"bare.glsl", "#include <b.glsl>\n"},
                                {"open.glsl", "#include \"b.glsl\n"},
                                {"behind.glsl", "#include \"b.glsl\" x\n"},
                                {"version.glsl", "// top\n#version 450\n"}};
    EXPECT_EQ(error_of(files, "none.glsl"), "no shader file 'none.glsl'");
    EXPECT_EQ(error_of(files, "unknown.glsl"), "unknown.glsl:2: no shader file 'nowhere.glsl'");
    EXPECT_EQ(error_of(files, "a.glsl"), "a.glsl:1: b.glsl:2: 'a.glsl' includes itself");
    EXPECT_EQ(error_of(files, "self.glsl"), "self.glsl:1: 'self.glsl' includes itself");
    for (const char* name : {"bare.glsl", "open.glsl", "behind.glsl"})
        EXPECT_EQ(error_of(files, name),
                  std::string(name) + ":1: an include is written #include \"file.glsl\"");
    EXPECT_EQ(error_of(files, "version.glsl").find("version.glsl:2: "), 0u);
}

TEST(ShaderSource, DepthIsBounded) {
    std::vector<std::string> names, texts;
    for (int i = 0; i <= max_include_depth; ++i) {
        names.push_back(std::string("f").append(std::to_string(i)));
        texts.push_back(std::string("#include \"f").append(std::to_string(i + 1)).append("\"\n"));
    }
    texts.back().clear();
    texts[max_include_depth - 1].clear();
    const auto files = [&] {
        std::vector<ShaderFile> list;
        for (std::size_t i = 0; i < names.size(); ++i)
            list.push_back({names[i], texts[i]});
        return list;
    };
    EXPECT_TRUE(shader_source(files(), "f0", ShaderDialect::gl450));
    texts[max_include_depth - 1] = "#include \"f" + std::to_string(max_include_depth) + "\"\n";
    EXPECT_NE(error_of(files(), "f0").find("nested too deeply"), std::string::npos);
}

TEST(ShaderSource, RefusesDefinesThatAreNotValidGlsl) {
    const ShaderFile files[] = {{"a.glsl", ""}};
    const std::vector<std::vector<ShaderDefine>> bad = {{{"", "1"}},
                                                        {{"1A", "1"}},
                                                        {{"A B", "1"}},
                                                        {{"gl_X", "1"}},
                                                        {{"GL_X", "1"}},
                                                        {{"A__B", "1"}},
                                                        {{"defined", "1"}},
                                                        {{"A(x)", "x"}},
                                                        {{"A", "1\n#define B 2"}},
                                                        {{"A", "1 \\"}},
                                                        {{"A", "1\r2"}},
                                                        {{"A", std::string("1\0", 2)}},
                                                        {{"A", "1"}, {"B", "2"}, {"A", "1"}}};
    for (const auto& defines : bad)
        EXPECT_FALSE(error_of(files, "a.glsl", defines).empty());
}

TEST(Shaders, AreEmbedded) {
    EXPECT_FALSE(shader_programs().empty()) << "no *.comp.glsl, *.vert.glsl or *.frag.glsl";
}

struct Source {
    std::string text, stage;
};

#ifdef TESSERA_GLSLANG
struct Run {
    int status;
    std::string output;
};

Run run(const std::string& command) {
    Run result{-1, {}};
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    if (pipe == nullptr)
        return result;
    std::array<char, 4096> part;
    for (std::size_t n; (n = std::fread(part.data(), 1, part.size(), pipe)) > 0;)
        result.output.append(part.data(), n);
    result.status = pclose(pipe);
    return result;
}

// The validator links SPIR-V sources of one call into one program, so each needs a call of its own.
bool goes_alone(ShaderDialect dialect) {
    return dialect != ShaderDialect::es310;
}

// glslangValidator's log if it refuses a source. One process checks many sources, because starting
// it takes most of the time.
std::optional<std::string> refusal(const std::vector<Source>& sources, ShaderDialect dialect) {
    std::string pattern = (std::filesystem::temp_directory_path() / "tessera_shader_XXXXXX");
    if (mkdtemp(pattern.data()) == nullptr)
        return "cannot create a temporary folder";
    const std::filesystem::path folder = pattern;
    std::string command = std::string("'") + TESSERA_GLSLANG + "'";
    if (goes_alone(dialect)) {
        command += dialect == ShaderDialect::vulkan ? " -V" : " --target-env opengl";
        command += " -o '" + (folder / "shader.spv").string() + "'";
    }
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const std::string file = folder / (std::to_string(i) + "." + sources[i].stage);
        std::ofstream(file, std::ios::binary) << sources[i].text;
        command += " '" + file + "'";
    }
    const Run result = run(command);
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
    if (result.status == 0)
        return std::nullopt;
    return sources.size() == 1 ? explain_shader_log(result.output, sources[0].text) : result.output;
}
#endif

const std::pair<ShaderDialect, const char*> dialects[] = {{ShaderDialect::gl450, "OpenGL 4.5"},
                                                          {ShaderDialect::es310, "ES 3.1"},
                                                          {ShaderDialect::vulkan, "Vulkan"}};

TEST(Shaders, EveryProgramIsValidGlslInEveryDialect) {
    const auto programs = shader_programs();
    ASSERT_FALSE(programs.empty());
    for (const auto& [dialect, dialect_name] : dialects) {
        SCOPED_TRACE(dialect_name);
        std::vector<Source> sources;
        for (const ShaderProgram& program : programs) {
            const auto source = shader_source(program.name, dialect, program.defines);
            ASSERT_TRUE(source) << program.label() << ": " << source.status().message();
            sources.push_back({*source, program.stage});
        }
#ifdef TESSERA_GLSLANG
        if (!goes_alone(dialect) && !refusal(sources, dialect))
            continue;
        for (std::size_t i = 0; i < sources.size(); ++i)
            EXPECT_EQ(refusal({sources[i]}, dialect).value_or(""), "") << programs[i].label();
#endif
    }
#ifndef TESSERA_GLSLANG
    GTEST_SKIP() << "glslangValidator was not found by CMake";
#endif
}

#ifdef TESSERA_GLSLANG
TEST(Shaders, ValidatorDetectsErrors) {
    const ShaderFile files[] = {
        {"bad.comp.glsl",
         "layout(local_size_x = 1) in;\nvoid main() {\n    int x = nothing;\n}\n"}};
    for (const auto& [dialect, dialect_name] : dialects) {
        const auto source = shader_source(files, "bad.comp.glsl", dialect);
        ASSERT_TRUE(source);
        const auto log = refusal({{*source, "comp"}}, dialect);
        ASSERT_TRUE(log) << dialect_name;
        EXPECT_NE(log->find("bad.comp.glsl:3 |     int x = nothing;"), std::string::npos) << *log;
        if (!goes_alone(dialect)) {
            const Source good{"#version 310 es\nvoid main() {}\n", "vert"};
            EXPECT_TRUE(refusal({good, {*source, "comp"}, good}, dialect)) << dialect_name;
            EXPECT_FALSE(refusal({good, good}, dialect)) << dialect_name;
        }
    }
}
#endif

} // namespace
} // namespace tessera::test
