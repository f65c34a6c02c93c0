// Builds files from the parts of other files.
#pragma once

#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "tests/support/vector_sink.h"

#include <gtest/gtest.h>
#include <vector>

namespace tessera::test {

// The contents of `file` without its tiles, for rewriting level 0; the caller adds the tiles.
// Borrows from `file`.
inline ContainerContents contents_of(const ContainerReader& file) {
    const FileHeader& header = file.header();
    ContainerContents contents;
    contents.desc = header.desc;
    contents.tile_extent = header.tile_extent;
    contents.description = header.description;
    contents.colour = header.colour;
    contents.background = header.background;
    contents.required_features = header.required_features;
    contents.codec_parameters = file.codec_parameters();
    return contents;
}

// Applies edit(contents, tiles) to a file and writes it with correct checksums, without coarse
// levels and alignment.
template <class Edit>
std::vector<std::byte> rewritten(const std::vector<std::byte>& file, const Edit& edit) {
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    EXPECT_TRUE(reader) << reader.status().message();
    ContainerContents contents = contents_of(*reader);
    std::vector<std::vector<std::byte>> tiles(reader->tile_count());
    for (std::uint64_t i = 0; i < tiles.size(); ++i)
        EXPECT_TRUE(reader->read_tile(i, tiles[i]));
    edit(contents, tiles);
    contents.tile = [&](std::uint64_t i) { return std::span<const std::byte>(tiles[i]); };
    std::vector<std::byte> out;
    VectorSink sink(out);
    EXPECT_TRUE(write_container(contents, sink));
    return out;
}

} // namespace tessera::test
