// The contents of a file: a pass over the texture and its coarse levels.
#pragma once

#include "codec/encode/coarse_levels.h"
#include "format/container/container_writer.h"

#include <cstddef>
#include <vector>

namespace tessera {

// All arguments outlive it. contents() refers to it.
class FileContents {
public:
    FileContents(const EncodePlan& plan, const PassResult& pass,
                 const std::vector<CoarseLevel>& levels);
    FileContents(const FileContents&) = delete;
    FileContents& operator=(const FileContents&) = delete;

    const ContainerContents& contents() const { return contents_; }
    // The size of the file. Errors: bad_argument (a file cannot hold this).
    Result<std::uint64_t> bytes() const { return container_bytes(contents_); }

private:
    // A tile and the payloads of its level, in which it has this number.
    struct Place {
        const CodedTile& tile;
        const TileStore& payloads;
        std::uint64_t number;
    };
    Place place_of(std::uint64_t tile) const;
    bool has_stored_tiles() const;
    void choose_metadata();

    const EncodePlan& plan_;
    const PassResult& pass_;
    const std::vector<CoarseLevel>& levels_;
    const std::vector<std::byte> coding_; // section CODE
    std::vector<std::byte> payload_;      // of the tile that is written
    ContainerContents contents_;
};

} // namespace tessera
