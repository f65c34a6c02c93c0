// Writes a .tess file from its parts.
#pragma once

#include "format/container/level_table.h"
#include "format/container/syntax.h"
#include "format/metadata.h"
#include "format/output_file.h"
#include "format/status.h"
#include "format/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// Receives bytes in order.
class ByteSink {
public:
    virtual ~ByteSink() = default;
    virtual Status append(std::span<const std::byte> bytes) = 0;
};

// Appends to a file, which the caller commits.
class FileSink : public ByteSink {
public:
    explicit FileSink(OutputFile& file) : file_(file) {}
    Status append(std::span<const std::byte> bytes) override { return file_.append(bytes); }

private:
    OutputFile& file_;
};

struct ExtraSection {
    std::string type; // four ASCII letters that FORMAT.md does not define
    std::span<const std::byte> bytes;
};

// Everything that goes into a file. Spans must stay valid until write_container() returns.
struct ContainerContents {
    TextureDesc desc;
    // Texels: 1..64 along u and v, 1..32 along s and t, product at most 393,216.
    Extent4 tile_extent{32, 32, 8, 8};
    Description description;
    Metadata metadata;
    ColourTransform colour = ColourTransform::none;
    // One sample per channel, a half as its bits; 0 for channels that the texture does not have.
    std::array<std::uint16_t, 4> background{};
    // Those of coarse levels and of aligned views are added automatically.
    std::uint64_t required_features = 0;
    ViewAlignment alignment; // must be 0, 0 if there are coarse levels or a proxy
    // The target size of a page: a multiple of 16 up to 65,536, or 0 to give every tile its own
    // page. By default the smallest of 0, 16, 32, 64, ... with which the checksums of pages cost at
    // most 1 % of the bytes of all tiles.
    std::optional<std::uint32_t> page_bytes;
    std::span<const std::byte> codec_parameters; // section CODE
    std::span<const std::byte> proxy_mesh;       // section prxy; only if the proxy is a mesh
    std::vector<ExtraSection> extra;
    std::vector<LevelEntry> coarse_levels; // levels 1, 2, ...
    // Returns the bytes of a tile, none if all its texels are background. Tiles are numbered over
    // all levels. It is called several times for each tile, in the order of the tiles' bytes, and
    // must return the same bytes each time. The span is used only until the next call, so that the
    // callback may reuse one buffer. Its errors become those of write_container().
    std::function<Result<std::span<const std::byte>>(std::uint64_t tile)> tile;
    // Returns the number of bytes that `tile` returns, for callbacks that load them. Optional.
    std::function<std::uint64_t(std::uint64_t tile)> tile_length;
};

// The number of bytes that write_container() will write. It needs only the length of every tile.
// Errors: those of write_container().
Result<std::uint64_t> container_bytes(const ContainerContents& contents);

// Appends the whole file to `sink` and returns its length in bytes. The bytes depend only on
// `contents`. Holds the index in memory, about two bytes per tile, but not the tiles. Errors:
// bad_argument (a field outside the ranges of FORMAT.md 1.1, too many tiles, metadata beyond its
// limits, a section type that is taken), unsupported (the head or the index is too large), and
// those of `sink` and `contents.tile`.
Result<std::uint64_t> write_container(const ContainerContents& contents, ByteSink& sink);

} // namespace tessera
