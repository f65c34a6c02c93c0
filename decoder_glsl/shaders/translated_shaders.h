// The shaders in HLSL, MSL and WGSL. decoder_glsl/dialects/translate.py translates them from GLSL
// before the library is built, once for each set of macros that changes a program.
#pragma once

#include "decoder_glsl/shader_source.h"

#include <cstddef>
#include <span>

namespace tessera {

bool is_translated(ShaderDialect dialect);

// What shader_source() and shader_names() return for a translated dialect.
Result<std::string> translated_shader(std::string_view name, ShaderDialect dialect,
                                      std::span<const ShaderDefine> defines);
std::vector<std::string_view> translated_names(ShaderDialect dialect);

// The archive that translate.py writes: a zstd frame (embed_translations.cmake).
std::span<const std::byte> packed_translations();

} // namespace tessera
