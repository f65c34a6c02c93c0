// The files for browsers that the tool contains: the decoder, its loader and the viewer.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace tessera {

struct WebFile {
    std::string_view name; // without folder, such as "tessera.js"
    std::span<const std::byte> bytes;
};

// All files. tessera.wasm.gz is among them only if the build found a compiler for WebAssembly
// (tools/web/CMakeLists.txt). Thread-safe.
std::span<const WebFile> web_files();

} // namespace tessera
