// Tests shader sources (heads, includes, errors), and checks every program against the GLSL
// specification.
#include "decoder_glsl/shader_source.h"
#include "decoder_glsl/shaders/shader_files.h"
#include "decoder_glsl/shaders/shader_log.h"
#include "tests/support/shader_programs.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <optional>
#include <set>
#include <string>
#include <utility>
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

const ShaderDialect all_translated[] = {ShaderDialect::hlsl, ShaderDialect::msl,
                                        ShaderDialect::wgsl};

bool contains(std::span<const std::string_view> words, std::string_view word) {
    return std::ranges::find(words, word) != words.end();
}

TEST(TranslatedShaders, HoldSamplerDecoderAndLayers) {
    for (const ShaderDialect dialect : all_translated) {
        const auto names = shader_names(dialect);
        for (const char* name :
             {"tree.comp.glsl", "levels.comp.glsl", "corrections.comp.glsl", "order.comp.glsl",
              "items.comp.glsl", "groups.comp.glsl", "texels.comp.glsl", "border.comp.glsl",
              "filter.comp.glsl", "mips.comp.glsl", "coarse.comp.glsl", "sample.glsl",
              "mesh.vert.glsl", "mesh.frag.glsl", "layered_mesh.frag.glsl"}) {
            EXPECT_TRUE(contains(names, name)) << name;
            const auto source = shader_source(name, dialect);
            ASSERT_TRUE(source) << source.status().message();
            EXPECT_TRUE(source->starts_with(std::string("// ") + name + ", source ")) << name;
        }
        EXPECT_FALSE(contains(names, "render.comp.glsl"));
    }
}

TEST(TranslatedShaders, SamplerIsCallableByItsName) {
    const auto sampler = [](ShaderDialect dialect) {
        const auto source = shader_source("sample.glsl", dialect);
        return source ? *source : source.status().message();
    };
    EXPECT_EQ(count(sampler(ShaderDialect::hlsl),
                    "float4 tessera_sample(float3 from_centre, float3 direction)\n"),
              1u);
    EXPECT_EQ(count(sampler(ShaderDialect::msl),
                    "float4 tessera_sample(thread const float3& from_centre, "
                    "thread const float3& direction, "),
              1u);
    EXPECT_EQ(count(sampler(ShaderDialect::wgsl),
                    "fn tessera_sample(from_centre : vec3<f32>, direction : vec3<f32>) -> "
                    "vec4<f32> {\n"),
              1u);
    for (const ShaderDialect dialect : all_translated) {
        EXPECT_NE(sampler(dialect).find(" tessera_sample_surface("), std::string::npos);
        EXPECT_EQ(sampler(dialect).find("main"), std::string::npos) << "it has no entry point";
    }
}

TEST(TranslatedShaders, MacrosChooseTheTranslation) {
    const ShaderDefine cache[] = {{"TESSERA_RESIDENT_CACHE", "1"}};
    const ShaderDefine half[] = {{"TSR_OUTPUT_HALF", "1"}};
    for (const ShaderDialect dialect : all_translated) {
        const auto plain = shader_source("sample.glsl", dialect);
        const auto cached = shader_source("sample.glsl", dialect, cache);
        ASSERT_TRUE(plain && cached);
        EXPECT_EQ(count(*plain, "tessera_marks"), 0u);
        EXPECT_GT(count(*cached, "tessera_marks"), 0u);
        const auto halves = shader_source("sample.glsl", dialect, half);
        ASSERT_TRUE(halves);
        EXPECT_EQ(*halves, *plain) << "the macro does not concern this shader";
    }
    EXPECT_GT(count(*shader_source("texels.comp.glsl", ShaderDialect::wgsl), "rgba8unorm"), 0u);
    EXPECT_GT(count(*shader_source("texels.comp.glsl", ShaderDialect::wgsl, half), "rgba16float"),
              0u);
}

TEST(TranslatedShaders, RefuseWhatIsNotTranslated) {
    const ShaderDefine moved[] = {{"TESSERA_UNIT_TEXELS", "3"}};
    const auto refused = shader_source("sample.glsl", ShaderDialect::hlsl, moved);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(refused.status().message(),
              "the shaders in hlsl have no macro 'TESSERA_UNIT_TEXELS', only "
              "TESSERA_COVERAGE_ONLY, TESSERA_HARDWARE_FILTER, TESSERA_RESIDENT_CACHE, "
              "TSR_OUTPUT_HALF, TSR_PREDICTED_TILES");
    const auto program = shader_source("render.comp.glsl", ShaderDialect::wgsl);
    ASSERT_FALSE(program);
    EXPECT_EQ(program.status().message(), "no shader 'render.comp.glsl' in wgsl");
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

// The identifiers of a shader file outside comments and preprocessor lines.
std::set<std::string> identifiers(std::string_view text) {
    std::set<std::string> words;
    for (std::size_t end = 0; !text.empty(); text.remove_prefix(std::min(end + 1, text.size()))) {
        end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        line = line.substr(0, line.find("//"));
        if (line.starts_with('#'))
            continue;
        std::string word;
        for (const char c : std::string(line) + ' ') {
            if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_')
                word += c;
            else if (!word.empty())
                words.insert(std::exchange(word, {}));
        }
    }
    return words;
}

// Translators would rename them, and hosts could not find the names.
TEST(Shaders, HaveNoNamesThatOtherLanguagesReserve) {
    const char* const reserved[] = {
        "NULL",     "Self",       "abstract",  "active",  "as",       "asm",     "async",
        "auto",     "class",      "common",    "compile", "crate",    "delete",  "demote",
        "device",   "enum",       "export",    "extern",  "filter",   "final",   "fn",
        "friend",   "from",       "get",       "goto",    "half",     "impl",    "import",
        "inline",   "instanceof", "interface", "kernel",  "let",      "line",    "linear",
        "loop",     "macro",      "match",     "matrix",  "meta",     "mod",     "module",
        "move",     "mut",        "namespace", "new",     "nil",      "noise",   "of",
        "operator", "override",   "package",   "partial", "pass",     "patch",   "point",
        "priv",     "ptr",        "pub",       "ref",     "register", "require", "resource",
        "sample",   "self",       "set",       "snorm",   "static",   "string",  "super",
        "target",   "technique",  "template",  "texture", "this",     "thread",  "throw",
        "trait",    "triangle",   "type",      "union",   "unless",   "unorm",   "use",
        "using",    "var",        "vector",    "vertex",  "virtual",  "where",   "with",
        "yield"};
    for (const ShaderFile& file : shader_files()) {
        const auto words = identifiers(file.text);
        for (const char* word : reserved)
            EXPECT_FALSE(words.contains(word)) << file.name << ": " << word;
    }
}

#ifdef TESSERA_GLSLANG
// OpenGL ES and the translated dialects keep a list of textures, which no variable indexes.
TEST(Shaders, DrawLayersWithoutArraysOfTextures) {
    std::vector<ShaderDefine> defines = {{"TESSERA_TEXTURES", "12"}, {"TESSERA_LIGHTS", "5"}};
    int number = 0;
    for (const char* role :
         {"EMISSION", "SPECULAR", "ROUGHNESS", "NORMAL", "VISIBILITY", "REFLECTION", "COVERAGE",
          "ENVIRONMENT", "DIFFERENCE", "SHARED_DIFFERENCE", "OPACITY"})
        defines.emplace_back(std::string("TESSERA_LAYER_") + role, std::to_string(++number));
    const auto es = shader_source("layered_mesh.frag.glsl", ShaderDialect::es310, defines);
    ASSERT_TRUE(es);
    EXPECT_EQ(refusal({{*es, "frag"}}, ShaderDialect::es310).value_or(""), "");
    const ShaderDefine translated[] = {{"TSR_TRANSLATED", "1"}};
    for (const char* name : {"layered_mesh.frag", "mips.comp", "border.comp", "texels.comp"}) {
        const auto source =
            shader_source(std::string(name) + ".glsl", ShaderDialect::vulkan, translated);
        ASSERT_TRUE(source);
        const std::string stage = std::string(name).substr(std::string(name).find('.') + 1);
        EXPECT_EQ(refusal({{*source, stage}}, ShaderDialect::vulkan).value_or(""), "") << name;
    }
}

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
