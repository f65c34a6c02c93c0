// The files of decoder_glsl/shaders, as text inside the library (embed_shaders.cmake).
#pragma once

#include <span>
#include <string_view>

namespace tessera {

struct ShaderFile {
    std::string_view name; // "tree.glsl"
    std::string_view text;
};

std::span<const ShaderFile> shader_files();

} // namespace tessera
