// A whole file: opened, validated, every part of it that is small enough decoded.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "format/container/index.h"
#include "format/container/level_table.h"
#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"

namespace tessera::fuzz {
namespace {

void mend_head(Bytes& file) {
    if (file.size() < header_bytes)
        return;
    const FileHeader header = load_header(std::span(file).first<header_bytes>());
    const std::size_t table = std::size_t{header.section_count} * section_entry_bytes;
    if (file.size() - header_bytes < table)
        return;
    for (std::size_t at = header_bytes; at < header_bytes + table; at += section_entry_bytes) {
        SectionEntry entry = load_section(std::span(file).subspan(at).first<section_entry_bytes>());
        if (entry.crc == 0 || entry.offset > file.size() ||
            entry.length > file.size() - entry.offset)
            continue; // DATA and INDX have their own
        entry.crc = crc32c(std::span(file).subspan(entry.offset, entry.length));
        const auto stored = store_section(entry);
        std::copy(stored.begin(), stored.end(), file.begin() + static_cast<std::ptrdiff_t>(at));
    }
    store_le(file.data() + header_crc_offset,
             crc32c(std::span(file).subspan(header_bytes, table),
                    crc32c(std::span(file).first<header_crc_offset>())));
}

// The record of a group, at `at` in the file: its own checksum, then those of its pages that are there.
void mend_record(Bytes& file, std::span<std::byte> record, const GroupKey& key) {
    const auto mend_own = [&] {
        Bytes seed;
        append_le(seed, key.identity);
        append_le(seed, key.group);
        const auto body = record.first(record.size() - 4);
        store_le(record.data() + body.size(), crc32c(body, crc32c(seed)));
    };
    if (record.size() <= 4)
        return;
    mend_own();
    const Result<GroupIndex> index = read_index_record(record, key);
    if (!index)
        return;
    std::byte* crc = record.data() + record.size() - 4 - 4 * index->pages.size();
    for (std::size_t page = 0; page < index->pages.size(); ++page, crc += 4) {
        const auto& [offset, length, _] = index->pages[page];
        if (offset + length <= file.size())
            store_le(crc, page_crc(key.identity, key.group, static_cast<std::uint32_t>(page),
                                   std::span(file).subspan(offset, length)));
    }
    mend_own();
}

void mend_groups(Bytes& file) {
    const auto source = wrap_memory(file);
    const Result<ContainerReader> reader = ContainerReader::open(*source, OpenOptions{true});
    if (!reader)
        return;
    const FileHeader header = reader->header();
    const LevelTable table = reader->level_table();
    const auto bytes = reader->section_bytes("ROOT");
    const Bytes root(bytes.begin(), bytes.end());
    for (std::uint32_t group = 0; group < std::min(table.group_count(), 64u); ++group) {
        const std::byte* entry = root.data() + std::size_t{12} * group;
        const std::uint64_t begin =
                                header.head_size + std::uint64_t{load_le<std::uint32_t>(entry + 8)},
                            end = header.head_size +
                                  std::uint64_t{load_le<std::uint32_t>(entry + 20)};
        if (begin < end && end <= file.size())
            mend_record(file, std::span(file).subspan(begin, end - begin),
                        {header.identity, group, table.tiles_of(group).count,
                         load_le<std::uint64_t>(entry), load_le<std::uint64_t>(entry + 12),
                         header.page_bytes(), header.max_tile_bytes()});
    }
}

void read_everything(const Bytes& file) {
    const auto source = wrap_memory(file);
    const std::vector<Finding> findings = validate_container(*source);
    const Result<ContainerReader> container = ContainerReader::open(*source);
    if (!container) {
        require(!findings.empty(), "a file that does not open has no findings");
        return;
    }
    for (std::uint32_t group = 0; group < std::min(container->group_count(), 8u); ++group)
        (void)container->group(group);
    const Result<Decoder> decoder = Decoder::open(*source);
    if (!decoder)
        return;
    Box4 box = Box4::whole(decoder->desc().size);
    for (std::uint32_t& end : box.end)
        end = std::min(end, 12u);
    Bytes texels(decoder->desc().box_bytes(box));
    (void)decoder->decode_box(box, texels, 1, Integrity::page);
    (void)decoder->decode_box(box, texels, 1, Integrity::tile);
}

} // namespace

void mend(Bytes& file) {
    mend_head(file);
    mend_groups(file);
}

std::vector<Bytes> seeds() {
    std::vector<Bytes> all;
    for (const int channels : {1, 3, 4}) {
        const TextureDesc desc{{9, 6, 5, 4},
                               channels == 4 ? SampleType::half16 : SampleType::unorm8,
                               static_cast<std::uint8_t>(channels)};
        test::MemoryTexture texture = test::named_texture(desc, "smooth");
        EncodeOptions options;
        options.tile_extent = {5, 6, 3, 4};
        options.threads = 1;
        options.rate = channels == 3 ? RateTarget{RateTarget::Kind::max_error, 4}
                                     : RateTarget{RateTarget::Kind::quality, 40};
        options.metadata = {{"Author", "someone"}};
        Bytes file;
        require(encode_memory(texture, file, options).ok(), "a seed does not encode");
        all.push_back(file);
    }
    return all;
}

} // namespace tessera::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tessera;
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    fuzz::read_everything(fuzz::Bytes(bytes, bytes + size));
    return 0;
}
