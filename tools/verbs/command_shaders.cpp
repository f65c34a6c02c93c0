#include "decoder_glsl/shader_source.h"
#include "tools/support/option_checks.h"
#include "tools/support/output_folders.h"
#include "tools/verbs/command.h"

#include <cstdio>
#include <filesystem>

namespace tessera {
namespace {

struct ShadersCommand {
    std::string output, dialect = "gl450";
    std::vector<std::string> defines;
};

const std::pair<const char*, ShaderDialect> dialects[] = {{"gl450", ShaderDialect::gl450},
                                                          {"es310", ShaderDialect::es310},
                                                          {"vulkan", ShaderDialect::vulkan}};

Result<std::vector<ShaderDefine>> parse_defines(const std::vector<std::string>& words) {
    std::vector<ShaderDefine> defines;
    for (const std::string& word : words) {
        const std::size_t equals = word.find('=');
        if (equals == 0)
            return Status(ErrorCode::bad_argument, "--define " + word + ": a name is missing");
        defines.emplace_back(word.substr(0, equals),
                             equals == std::string::npos ? "1" : word.substr(equals + 1));
    }
    return defines;
}

// Programs whole; sample.glsl without a head, to be pasted into a program of the reader's own.
Status write_shader(std::string_view name, const ShadersCommand& a, ShaderDialect dialect,
                    std::span<const ShaderDefine> defines) {
    TESSERA_TRY_ASSIGN(std::string text, shader_source(name, dialect, defines));
    if (name == "sample.glsl")
        text.erase(0, text.find('\n') + 1); // the #version line
    return write_bytes((std::filesystem::path(a.output) / name).string(),
                       std::as_bytes(std::span(text)));
}

Status run(const ShadersCommand& a) {
    TESSERA_TRY_ASSIGN(const auto defines, parse_defines(a.defines));
    ShaderDialect dialect = ShaderDialect::gl450;
    for (const auto& [name, value] : dialects)
        if (a.dialect == name)
            dialect = value;
    std::error_code error;
    std::filesystem::create_directories(a.output, error);
    if (error)
        return {ErrorCode::io, a.output + ": " + error.message()};
    const std::vector<std::string_view> names = shader_names();
    for (const std::string_view name : names)
        TESSERA_TRY(write_shader(name, a, dialect, defines));
    std::printf("%s: %zu shaders for %s\n", a.output.c_str(), names.size(), a.dialect.c_str());
    return {};
}

} // namespace

void add_shaders_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, ShadersCommand& a) {
        c.add_option("-o,--output", a.output, "Folder to write to")->required();
        c.add_option("--dialect", a.dialect,
                     "gl450 (OpenGL 4.5), es310 (OpenGL ES 3.1) or vulkan (GLSL for SPIR-V)")
            ->check(one_of({"gl450", "es310", "vulkan"}))
            ->capture_default_str();
        c.add_option("-D,--define", a.defines,
                     "NAME or NAME=VALUE: TESSERA_RESIDENT_CACHE, TESSERA_HARDWARE_FILTER, "
                     "TSR_OUTPUT_HALF, ...");
    };
    add_verb<ShadersCommand>(
        app, chosen, "shaders", "Write the GPU decoder's shaders, each in one file",
        "sample.glsl holds tessera_sample(), for pasting into a shader of your "
        "own; its first lines\n"
        "say how. The .comp files decode, in this order: tree, levels, corrections, order, and "
        "then "
        "items,\n"
        "groups, texels as often as copies are deep, filter last. Storage buffers: 0 tables, 1 "
        "what "
        "to\n"
        "decode, 2 work, 3 coefficients; image 0 texels. Sampling: buffers 4 the texture, 5 marks "
        "of "
        "tiles;\n"
        "uniforms 2; texture unit 0 texels. Vulkan: buffers are set 0, images 1, textures 2, "
        "uniforms 3.\n\n"
        "Examples:\n"
        "  tessera shaders -o shaders/\n"
        "  tessera shaders -o spirv/ --dialect vulkan -D TESSERA_RESIDENT_CACHE",
        declare, run);
}

} // namespace tessera
