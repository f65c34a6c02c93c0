// A whole file: opened, validated, every part of it that is small enough decoded. A second round
// mends the checksums of header and sections, so that the fuzzer gets past them.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"

namespace tessera::fuzz {
namespace {

void mend(Bytes& file) {
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
    fuzz::Bytes file(bytes, bytes + size);
    fuzz::read_everything(file);
    fuzz::mend(file);
    fuzz::read_everything(file);
    return 0;
}
