// From a file of decoder_glsl/shaders to the complete source that a GLSL compiler takes.
//
// Shader files hold what all dialects share; the head that differs is made here:
//   #version                  450 core, 310 es, or 450 (for SPIR-V)
//   #define TSR_GL450 1   or TSR_ES310, TSR_VULKAN: for what a dialect cannot do otherwise
//   precision highp ...       ES only: of numbers and of every opaque type that we use
//   the caller's defines
// A line `#include "other.glsl"` becomes the text of that file, the first time that it is asked for.
// Conditions are not looked at: an #include inside #if 0 or a comment is expanded all the same.
//
// `#line N S` stands wherever the source changes files, so that compilers report line N of source
// string S; the comments `// source S: name` say which file S is (shader_log.h reads both). The head
// is source string 0.
//
// Conventions of the files: `*.comp.glsl`, `*.vert.glsl` and `*.frag.glsl` are programs and compile
// without any caller's define; plain `*.glsl` are for inclusion. No file has a #version line.
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
    vulkan, // GLSL 450 with Vulkan's rules, to be compiled to SPIR-V
};

// Name and value of a macro: the name an identifier that GLSL does not reserve, the value one line.
using ShaderDefine = std::pair<std::string, std::string>;

struct ShaderFile; // decoder_glsl/shaders/shader_files.h

constexpr int max_include_depth = 16;

// The complete source of the embedded file `name`. bad_argument: a file that does not exist, an
// include that is malformed, circular or too deep, a #version line, or a define that GLSL would not
// take; the message names file and line. Thread-safe.
Result<std::string> shader_source(std::string_view name, ShaderDialect dialect,
                                  std::span<const ShaderDefine> defines = {});

// The embedded files that stand for themselves: the programs, and sample.glsl for programs of others.
std::vector<std::string_view> shader_names();

// shader_source() of other files than the embedded ones.
Result<std::string> shader_source(std::span<const ShaderFile> files, std::string_view name,
                                  ShaderDialect dialect,
                                  std::span<const ShaderDefine> defines = {});

} // namespace tessera
