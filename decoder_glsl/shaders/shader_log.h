// Adds file names and source lines to the log of a GLSL compiler.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// Returns the log with a line behind every message that names a source string and a line: the file,
// the line's number and its text. It knows the forms "0:12(5):" (Mesa), "0(12) :" (NVIDIA) and
// "ERROR: 0:12:" (glslang, AMD, Apple). `source` is the compiled text; its `#line N S` and `//
// source S: name` lines name files and lines. Without them lines are counted from the top. Pure,
// thread-safe.
std::string explain_shader_log(std::string_view log, std::string_view source);

} // namespace tessera
