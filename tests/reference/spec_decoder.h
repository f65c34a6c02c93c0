// A second, simple decoder of the Tessera format, written from format/FORMAT.md and the normative
// tables in format/tables/ alone.
//
// It serves to check the specification and the library against each other, so it shares no code
// with the library. It holds the whole file in memory, checks everything and decodes one tile at a
// time.
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

// Decodes the texels of all levels. Returns nothing for an invalid file and puts the reason in
// `error`.
std::optional<Decoded> decode(std::span<const std::byte> file, std::string& error);

// CRC32C as FORMAT.md's notation defines it. `crc` is the CRC of the preceding bytes.
std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t crc = 0);

} // namespace tessera_reference
