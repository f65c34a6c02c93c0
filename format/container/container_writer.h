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

// Takes bytes in order.
class ByteSink {
public:
    virtual ~ByteSink() = default;
    virtual Status append(std::span<const std::byte> bytes) = 0;
};

// Appends to a file; the caller commits it.
class FileSink : public ByteSink {
public:
    explicit FileSink(OutputFile& file) : file_(file) {}
    Status append(std::span<const std::byte> bytes) override { return file_.append(bytes); }

private:
    OutputFile& file_;
};

struct ExtraSection {
    std::string type; // four ASCII letters, none that FORMAT.md defines
    std::span<const std::byte> bytes;
};

// Everything that goes into a file. Spans are borrowed until write_container returns.
struct ContainerContents {
    TextureDesc desc;
    Extent4 tile_extent{
        32, 32, 8, 8}; // texels, 1..64 along u and v, 1..32 along s and t, product at most 393,216
    Description description;
    Metadata metadata;
    ColourTransform colour = ColourTransform::none;
    std::array<std::uint16_t, 4> background{}; // samples (half bits for half16), unused channels 0
    std::uint64_t required_features = 0;       // those of coarse levels and of alignment are added
    ViewAlignment alignment;                   // only without coarse levels and without a proxy
    // What a page aims at: a multiple of 16 up to 65,536; 0: every tile is a page. Unless given, the
    // least of 0, 16, 32, 64, ... with which checksums of pages cost at most 1 % of all tiles' bytes.
    std::optional<std::uint32_t> page_bytes;
    std::span<const std::byte> codec_parameters; // section CODE
    std::span<const std::byte> proxy_mesh;       // section prxy, only when the proxy is a mesh
    std::vector<ExtraSection> extra;
    std::vector<LevelEntry> coarse_levels; // 1, 2, ...; sets the required feature
    // Bytes of a tile, numbered over all levels; empty: all background. Called several times a tile,
    // each time in the order of their bytes, and must answer the same each time. The span is used
    // until the next call only, so a callback may fill one buffer again and again. Its errors are
    // those of write_container.
    std::function<Result<std::span<const std::byte>>(std::uint64_t tile)> tile;
    // Length of what `tile` gives, for callbacks that read it from somewhere; may be left out.
    std::function<std::uint64_t(std::uint64_t tile)> tile_length;
};

// Bytes that write_container will write. Costs a look at every tile's length only. Same errors.
Result<std::uint64_t> container_bytes(const ContainerContents& contents);

// Appends the whole file to `sink` and returns its length in bytes. The bytes depend on `contents`
// only. Memory: the index, about two bytes a tile; tiles are passed through.
// Errors: bad_argument (a field outside the ranges of FORMAT.md 1.1, too many tiles, metadata
// beyond its limits, a section type that is taken), unsupported (head or index too large), and what
// `sink` and `contents.tile` report.
Result<std::uint64_t> write_container(const ContainerContents& contents, ByteSink& sink);

} // namespace tessera
