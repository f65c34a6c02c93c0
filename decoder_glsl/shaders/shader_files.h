// The files of decoder_glsl/shaders, which the library holds as text (embed_shaders.cmake).
#pragma once

#include "decoder_glsl/shader_source.h"

#include <span>
#include <string_view>

namespace tessera {

struct ShaderFile {
    std::string_view name; // "tree.glsl"
    std::string_view text;
};

std::span<const ShaderFile> shader_files();

constexpr int max_include_depth = 16;

// shader_source() with other files than the embedded ones.
Result<std::string> shader_source(std::span<const ShaderFile> files, std::string_view name,
                                  ShaderDialect dialect,
                                  std::span<const ShaderDefine> defines = {});

} // namespace tessera
