// What a GLSL compiler complains of, with file names and the lines themselves.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// A driver's log in which every message that names a place is followed by that place's file, line
// and text, where the log's form is known: "0:12(5):" (Mesa), "0(12) :" (NVIDIA), "ERROR: 0:12:"
// (glslang, AMD, Apple). `source` is what was compiled; its `#line N S` and `// source S: name`
// lines are followed, and without them lines count from the top. Pure, thread-safe.
std::string explain_shader_log(std::string_view log, std::string_view source);

} // namespace tessera
