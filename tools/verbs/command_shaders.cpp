#include "decoder_glsl/shader_source.h"
#include "format/output_file.h"
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
            return Status(ErrorCode::bad_argument, "--define " + word + ": needs a name");
        defines.emplace_back(word.substr(0, equals),
                             equals == std::string::npos ? "1" : word.substr(equals + 1));
    }
    return defines;
}

// Programs are written whole. sample.glsl is pasted into other programs, so its #version line goes.
Status write_shader(std::string_view name, const ShadersCommand& a, ShaderDialect dialect,
                    std::span<const ShaderDefine> defines) {
    TESSERA_TRY_ASSIGN(std::string text, shader_source(name, dialect, defines));
    if (name == "sample.glsl")
        text.erase(0, text.find('\n') + 1); // the #version line
    return write_bytes((to_path(a.output) / name).string(), std::as_bytes(std::span(text)));
}

Status run(const ShadersCommand& a) {
    TESSERA_TRY_ASSIGN(const auto defines, parse_defines(a.defines));
    ShaderDialect dialect = ShaderDialect::gl450;
    for (const auto& [name, value] : dialects)
        if (a.dialect == name)
            dialect = value;
    std::error_code error;
    std::filesystem::create_directories(to_path(a.output), error);
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
                     "gl450: OpenGL 4.5 (default); es310: OpenGL ES 3.1; vulkan: GLSL for SPIR-V")
            ->check(one_of({"gl450", "es310", "vulkan"}))
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
        "set 1, textures in set 2, uniforms in set 3.\n\n"
        "Examples:\n"
        "  tessera shaders -o shaders/\n"
        "  tessera shaders -o spirv/ --dialect vulkan -D TESSERA_RESIDENT_CACHE",
        declare, run);
}

} // namespace tessera
