// A second, plain decoder of the Tessera format, written from format/FORMAT.md alone.
// It reads the normative tables in format/tables/, too.
//
// It shares no code with the library and takes no shortcuts: the whole file in memory, everything
// checked, one tile after the other. It exists so that the document and the library can be checked
// against each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tessera_reference {

struct Decoded {
    std::uint32_t size[4]; // U, V, S, T
    int channels;
    int sample_type; // 0 unorm8, 1 half16
    std::map<std::string, std::string> metadata;
    std::vector<std::byte> texels; // of level 0, in the order v, u, t, s with s fastest
    std::vector<std::vector<std::byte>> coarse; // of levels 1, 2, ...
};

// The texels of all levels; nothing, and the reason in `error`, for a file that a reader refuses.
std::optional<Decoded> decode(std::span<const std::byte> file, std::string& error);

// CRC32C as FORMAT.md's notation defines it; `crc` continues the CRC of the bytes before.
std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t crc = 0);

} // namespace tessera_reference
