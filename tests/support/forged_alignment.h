// Forges files whose header claims that their views are aligned.
#pragma once

#include "format/container/syntax.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "tests/support/random.h"

#include <algorithm>
#include <cstdlib>

namespace tessera::test {

// Corrects the checksum of the header and its section table. Precondition: `file` has both.
inline void seal_header(std::span<std::byte> file) {
    const auto table = file.subspan(
        header_bytes, load_header(file.first<header_bytes>()).section_count * section_entry_bytes);
    store_le(file.data() + header_crc_offset, crc32c(table, crc32c(file.first(header_crc_offset))));
}

// Changes the header of a file without levels so that its texture becomes the tile grid of a
// smaller, aligned texture. The alignment is not checked: the smaller texture may have no texels.
inline Bytes with_alignment(Bytes file, ViewAlignment alignment) {
    const std::span<std::byte> bytes = file;
    FileHeader header = load_header(bytes.first<header_bytes>());
    auto& [u, v, s, t] = header.desc.size;
    u -= static_cast<std::uint32_t>(std::abs(alignment.u)) * (s - 1);
    v -= static_cast<std::uint32_t>(std::abs(alignment.v)) * (t - 1);
    header.alignment = alignment;
    header.required_features |= feature_aligned;
    std::ranges::copy(store_header(header), file.begin());
    seal_header(bytes);
    return file;
}

} // namespace tessera::test
