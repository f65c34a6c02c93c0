// What a browser gets, inside the tool: the decoder, its loader, the viewer.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace tessera {

struct WebFile {
    std::string_view name; // "tessera.js"
    std::span<const std::byte> bytes;
};

// tessera.wasm.gz is there only where the build had a compiler for it (tools/web/CMakeLists.txt).
std::span<const WebFile> web_files();

} // namespace tessera
