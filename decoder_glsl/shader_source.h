// Complete sources from the shader files of decoder_glsl/shaders, which the library holds as text:
// GLSL, or the translation of it to HLSL, MSL and WGSL (DIALECTS.md).
//
// Shader files contain what all dialects of GLSL share. shader_source() puts a head before them:
//   #version                  450 core, 310 es, or 450 (for SPIR-V)
//   #define TSR_GL450 1       or TSR_ES310, TSR_VULKAN, for code that depends on the dialect
//   precision highp ...       ES only, for numbers and for all opaque types in use
//   #define NAME VALUE        for each define of the caller
// The first line `#include "other.glsl"` becomes the text of that file, later ones nothing.
// Conditions are ignored: an #include inside #if 0 or in a comment block is expanded as well.
//
// Wherever the source changes files, a line `#line N S` makes compilers report line N of source
// string S, and a comment `// source S: name` gives the file's name. The head is source string 0.
//
// Files named *.comp.glsl, *.vert.glsl and *.frag.glsl are programs, which compile without any
// define of the caller. Other *.glsl files are for inclusion.
#pragma once

#include "format/status.h"

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace TESSERA_PUBLIC tessera {

enum class ShaderDialect {
    gl450,  // desktop OpenGL 4.5 core
    es310,  // OpenGL ES 3.1
    vulkan, // GLSL 450 by the rules of Vulkan, to be compiled to SPIR-V
    hlsl,   // shader model 6.0
    msl,    // Metal 2.1
    wgsl,   // WebGPU
};

// Name and value of a macro. The name is an identifier that GLSL does not reserve, the value one
// line. HLSL, MSL and WGSL exist for five macros, whose value does not matter:
// TESSERA_RESIDENT_CACHE, TESSERA_HARDWARE_FILTER, TESSERA_COVERAGE_ONLY, TSR_OUTPUT_HALF and
// TSR_PREDICTED_TILES.
using ShaderDefine = std::pair<std::string, std::string>;

// The complete source of the embedded file `name`, which is that of the GLSL for all dialects.
// Errors: bad_argument (the file does not exist, or is not a program that is translated; a define is
// not valid GLSL, or not one of the five above; an include is malformed, circular or too deep, in which case the
// message names file and line). Thread-safe.
Result<std::string> shader_source(std::string_view name, ShaderDialect dialect,
                                  std::span<const ShaderDefine> defines = {});

// Names of the embedded programs that exist in a dialect, and of sample.glsl, which programs of
// applications include. Thread-safe.
std::vector<std::string_view> shader_names(ShaderDialect dialect = ShaderDialect::gl450);

} // namespace tessera
