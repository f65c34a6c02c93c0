#include "decoder_glsl/shader_source.h"
#include "format/output_file.h"
#include "tools/support/option_checks.h"
#include "tools/support/output_folders.h"
#include "tools/verbs/command.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace tessera {
namespace {

struct ShadersCommand {
    std::string output, dialect = "glsl";
    std::vector<std::string> defines;
};

struct DialectChoice {
    const char* name;
    ShaderDialect dialect;
    const char* ending; // of files
};

const DialectChoice dialect_choices[] = {
    {"glsl", ShaderDialect::gl450, "glsl"},    {"es", ShaderDialect::es310, "glsl"},
    {"vulkan", ShaderDialect::vulkan, "glsl"}, {"hlsl", ShaderDialect::hlsl, "hlsl"},
    {"msl", ShaderDialect::msl, "metal"},      {"wgsl", ShaderDialect::wgsl, "wgsl"}};

Result<std::vector<ShaderDefine>> parse_defines(const std::vector<std::string>& words) {
    std::vector<ShaderDefine> defines;
    for (const std::string& word : words) {
        const std::size_t equals = word.find('=');
        if (equals == 0)
            return Status(ErrorCode::bad_argument, "--define " + word + ": needs a name");
        defines.emplace_back(word.substr(0, equals),
                             equals == std::string::npos ? "1" : word.substr(equals + 1));
    }
    return defines;
}

// Programs are written whole. sample.glsl is pasted into other programs, so its #version line goes.
Status write_shader(std::string_view name, const ShadersCommand& a, const DialectChoice& choice,
                    std::span<const ShaderDefine> defines) {
    TESSERA_TRY_ASSIGN(std::string text, shader_source(name, choice.dialect, defines));
    if (name == "sample.glsl" && text.starts_with("#version"))
        text.erase(0, text.find('\n') + 1);
    std::string file(name.substr(0, name.rfind('.') + 1));
    return write_bytes((to_path(a.output) / file.append(choice.ending)).string(),
                       std::as_bytes(std::span(text)));
}

Status run(const ShadersCommand& a) {
    TESSERA_TRY_ASSIGN(const auto defines, parse_defines(a.defines));
    const DialectChoice& choice =
        *std::ranges::find(dialect_choices, a.dialect, &DialectChoice::name);
    const std::vector<std::string_view> names = shader_names(choice.dialect);
    // Macros that do not exist are an error before anything is written.
    TESSERA_TRY(shader_source(names[0], choice.dialect, defines).status());
    std::error_code error;
    std::filesystem::create_directories(to_path(a.output), error);
    if (error)
        return {ErrorCode::io, a.output + ": " + error.message()};
    for (const std::string_view name : names)
        TESSERA_TRY(write_shader(name, a, choice, defines));
    std::printf("%s: %zu shaders for %s\n", a.output.c_str(), names.size(), a.dialect.c_str());
    return {};
}

} // namespace

void add_shaders_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, ShadersCommand& a) {
        c.add_option("-o,--output", a.output, "Folder to write to")->required();
        c.add_option(
             "--dialect", a.dialect,
             "glsl: OpenGL 4.5 (default); es: OpenGL ES 3.1; vulkan: GLSL for SPIR-V; hlsl: "
             "Direct3D 12; msl: Metal; wgsl: WebGPU")
            ->check(one_of({"glsl", "es", "vulkan", "hlsl", "msl", "wgsl"}))
            ->option_text("NAME");
        c.add_option(
             "-D,--define", a.defines,
             "A macro: TESSERA_RESIDENT_CACHE, TESSERA_HARDWARE_FILTER, TSR_OUTPUT_HALF ...")
            ->option_text("NAME[=VALUE]");
    };
    add_verb<ShadersCommand>(
        app, chosen, "shaders", "Write the GPU decoder's shaders, each in one file",
        "sample.glsl defines tessera_sample(); paste it into a shader of your own. Its first lines"
        " explain how. The .comp files decode. Run them in this order: tree, levels, corrections, "
        "order; then items, groups and texels, once per level of copies; then filter.\n\n"
        "Decoding uses the storage buffers 0 tables, 1 input, 2 work, 3 coefficients, and image 0 "
        "for the texels. Sampling uses the storage buffers 4 texture and 5 marks of tiles, uniform"
        " buffer 2, and texture unit 0 for the texels. In Vulkan, buffers are in set 0, images in "
        "set 1, textures in set 2, uniforms in set 3. HLSL (as spaces) and WGSL (as groups) have "
        "the "
        "same. They and MSL are translated ahead for five macros: the three above, "
        "TSR_PREDICTED_TILES and TESSERA_COVERAGE_ONLY.\n\n"
        "Examples:\n"
        "  tessera shaders -o shaders/\n"
        "  tessera shaders -o spirv/ --dialect vulkan -D TESSERA_RESIDENT_CACHE\n"
        "  tessera shaders -o hlsl/ --dialect hlsl -D TSR_OUTPUT_HALF",
        declare, run);
}

} // namespace tessera
