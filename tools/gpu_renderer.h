// Views drawn on the GPU.
#pragma once

#include "tools/view_renderer.h"

#include <memory>
#include <string>

namespace tessera {

// Draws the compressed `file`. `via` says how its texels reach the shader: "load" (tiles decoded
// on the CPU and uploaded), "feedback" (the shader asks for tiles, which the GPU decodes) or
// "sample" (tiles decoded while sampling). `budget_mib`: graphics memory for texels. Errors:
// unsupported, where there is no such GPU or way; those of reading the file.
Result<std::unique_ptr<ViewRenderer>>
make_gpu_renderer(const std::string& file, const std::string& via, unsigned budget_mib);

} // namespace tessera
