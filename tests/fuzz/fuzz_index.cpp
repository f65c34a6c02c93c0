// An index record must be refused or give positions inside DATA. The first bytes of the input are
// its key.
#include "format/container/index.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "tests/fuzz/fuzz_target.h"

namespace tessera::fuzz::index {
namespace {

constexpr std::size_t key_bytes = 8;

GroupKey key_of(std::span<const std::byte> input) {
    GroupKey key;
    key.identity = 77;
    key.group = std::to_integer<std::uint32_t>(input[0]);
    key.tiles = 1 + std::to_integer<std::uint32_t>(input[1]);
    key.page_bytes = 16 * (load_le<std::uint16_t>(input.data() + 2) % 4097u);
    key.data_begin = 1000;
    key.data_end = key.data_begin + load_le<std::uint32_t>(input.data() + 4);
    return key;
}

} // namespace

std::vector<Bytes> seeds() {
    std::vector<Bytes> all;
    for (const std::uint32_t tiles : {1u, 5u, 256u}) {
        std::vector<std::uint32_t> lengths;
        std::uint32_t total = 0;
        for (std::uint32_t i = 0; i < tiles; ++i) {
            lengths.push_back(i % 5 == 2 ? 0 : (i * 7919) % 900 + (i == 4 ? 70000 : 1));
            total += lengths.back();
        }
        const std::vector<std::uint32_t> crcs(split_into_pages(lengths, 4096).size(), 0x1234);
        Bytes input{std::byte{0}, static_cast<std::byte>(tiles - 1), std::byte{0}, std::byte{1}};
        append_le(input, total);
        append_bytes(input, write_index_record(77, 0, lengths, crcs));
        all.push_back(input);
    }
    return all;
}

void run(const std::uint8_t* data, std::size_t size) {
    const std::span input(reinterpret_cast<const std::byte*>(data), size);
    if (size < key_bytes)
        return;
    const GroupKey key = key_of(input);
    Bytes record(input.begin() + key_bytes, input.end());
    for (const bool mended : {false, true}) {
        if (mended && record.size() > 4) { // a correct checksum, so that the body is tested too
            Bytes seed;
            append_le(seed, key.identity);
            append_le(seed, key.group);
            const auto body = std::span(record).first(record.size() - 4);
            store_le(record.data() + body.size(), crc32c(body, crc32c(seed)));
        }
        const Result<GroupIndex> index = read_index_record(record, key);
        if (!index)
            continue;
        require(index->starts.size() == key.tiles + 1 && index->starts[0] == key.data_begin &&
                    index->starts.back() == key.data_end,
                "tiles do not span DATA");
        for (std::size_t i = 0; i < key.tiles; ++i) {
            require(index->starts[i] <= index->starts[i + 1], "tiles overlap");
            if (index->starts[i] == index->starts[i + 1])
                continue;
            const auto pages = index->pages_of(index->starts[i], index->starts[i + 1]);
            require(pages.begin < pages.end && pages.end <= index->pages.size(),
                    "a tile without pages");
        }
        std::uint64_t at = key.data_begin;
        for (const Page& page : index->pages) {
            require(page.offset == at && page.length > 0, "pages with gaps");
            at += page.length;
            const auto tiles = index->tiles_of(page);
            require(tiles.begin < tiles.end && tiles.end <= key.tiles, "a page without tiles");
        }
        require(at == key.data_end, "pages do not span DATA");
    }
}

const Registered registered({.name = "fuzz_index", .seeds = seeds, .run = run});

} // namespace tessera::fuzz::index
