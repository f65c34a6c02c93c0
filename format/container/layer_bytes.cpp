#include "format/container/layer_table.h"
#include "format/container/syntax.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

namespace tessera {
namespace {

// Bound on the beginnings of layers that are read together.
constexpr std::uint64_t most_beginning_bytes = std::uint64_t{1} << 20;

// The beginnings of all layers, which lie side by side, if they have been read together.
struct Beginnings {
    std::uint64_t offset = 0; // in the file of all layers
    std::vector<std::byte> bytes;

    // The bytes from there on, as many as are here.
    std::span<const std::byte> from(std::uint64_t begin) const {
        return begin < offset ? std::span<const std::byte>()
                              : std::span(bytes).subspan(static_cast<std::size_t>(
                                    std::min<std::uint64_t>(begin - offset, bytes.size())));
    }
};

// The file of a layer, whose beginning and data lie apart in the file of all layers.
class LayerBytes final : public ByteSource {
public:
    LayerBytes(ByteSource& file, const LayerInfo& layer, std::shared_ptr<const Beginnings> read)
        : file_(file), layer_(layer), read_(std::move(read)),
          name_(file.name() + ", layer " + name_of(layer.role)) {}

    // As many bytes as are there, if the end of the file of all layers is missing.
    std::uint64_t size() const override {
        const std::uint64_t end = file_.size();
        const auto present = [&](std::uint64_t offset, std::uint64_t bytes) {
            return std::min(bytes, end > offset ? end - offset : 0);
        };
        const std::uint64_t beginning = present(layer_.beginning_offset, layer_.beginning_bytes);
        return beginning < layer_.beginning_bytes
                   ? beginning
                   : beginning + present(layer_.data_offset, layer_.data_bytes);
    }
    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        const std::array<ReadRequest, 1> request{{{offset, out}}};
        return read_many(request);
    }
    Status read_many(std::span<const ReadRequest> requests) override {
        std::vector<ReadRequest> parts;
        for (const ReadRequest& request : requests) {
            TESSERA_TRY(check_range(*this, request.offset, request.out.size()));
            const std::uint64_t left =
                layer_.beginning_bytes - std::min(request.offset, layer_.beginning_bytes);
            const auto first =
                static_cast<std::size_t>(std::min<std::uint64_t>(left, request.out.size()));
            const auto here = read_->from(layer_.beginning_offset + request.offset);
            if (first <= here.size())
                std::ranges::copy(here.first(first), request.out.begin());
            else
                parts.push_back(
                    {layer_.beginning_offset + request.offset, request.out.first(first)});
            if (first < request.out.size())
                parts.push_back(
                    {layer_.data_offset + (request.offset + first) - layer_.beginning_bytes,
                     request.out.subspan(first)});
        }
        return parts.empty() ? Status() : file_.read_many(parts);
    }
    std::uint64_t opening_bytes() const override {
        return std::min<std::uint64_t>(layer_.beginning_bytes, first_read_bytes);
    }
    bool wants_prefetch() const override { return file_.wants_prefetch(); }
    std::string name() const override { return name_; }

private:
    ByteSource& file_;
    LayerInfo layer_;
    std::shared_ptr<const Beginnings> read_;
    std::string name_;
};

Result<Beginnings> read_beginnings(ByteSource& file, const Layers& layers) {
    Beginnings read;
    if (!layers.any() || !file.wants_prefetch())
        return read;
    read.offset = layers.further.front().beginning_offset;
    const std::uint64_t present = file.size() - std::min(read.offset, file.size());
    read.bytes.resize(static_cast<std::size_t>(
        std::min({layers.data_offset - read.offset, present, most_beginning_bytes})));
    TESSERA_TRY(file.read(read.offset, read.bytes));
    return read;
}

// A file of one texture, cut where its DATA begins.
struct CutFile {
    FileHeader header;
    std::span<const std::byte> table, sections, index, data;
};

Result<CutFile> cut(std::span<const std::byte> file) {
    if (file.size() < header_bytes)
        return Status(ErrorCode::bad_argument, "a layer is not a Tessera file");
    CutFile parts;
    parts.header = load_header(file.first<header_bytes>());
    if ((parts.header.required_features & feature_layers) != 0)
        return Status(ErrorCode::bad_argument, "a layer has layers of its own");
    parts.table = file.subspan(header_bytes, parts.header.section_count * section_entry_bytes);
    std::size_t sections = 0;
    for (std::size_t i = 0; i < parts.header.section_count; ++i)
        sections +=
            load_section(parts.table.subspan(i * section_entry_bytes).first<section_entry_bytes>())
                .length;
    parts.sections = file.subspan(header_bytes + parts.table.size(), sections);
    const std::size_t head = header_bytes + parts.table.size() + sections;
    parts.index = file.subspan(head, parts.header.index_size);
    parts.data = file.subspan(head + parts.header.index_size);
    return parts;
}

// Adds section LAYR to the head of the first layer's file.
std::vector<std::byte> first_beginning(const CutFile& first, std::span<const std::byte> section,
                                       std::uint64_t other_bytes) {
    FileHeader header = first.header;
    header.required_features |= feature_layers;
    header.version_minor = version_minor_layers;
    header.file_size += section_entry_bytes + section.size() + other_bytes;
    ++header.section_count;
    std::vector<std::byte> table(first.table.begin(), first.table.end());
    append_bytes(table, store_section({.type = {'L', 'A', 'Y', 'R'},
                                       .crc = crc32c(section),
                                       .length = static_cast<std::uint32_t>(section.size())}));
    std::array<std::byte, header_bytes> bytes = store_header(header);
    const auto summed = std::span(bytes).first<header_crc_offset>();
    store_le(bytes.data() + header_crc_offset, crc32c(table, crc32c(summed)));
    std::vector<std::byte> out(bytes.begin(), bytes.end());
    append_bytes(out, table);
    append_bytes(out, first.sections);
    append_bytes(out, section);
    append_bytes(out, first.index);
    return out;
}

} // namespace

std::unique_ptr<ByteSource> layer_bytes(ByteSource& file, const LayerInfo& layer) {
    return std::make_unique<LayerBytes>(file, layer, std::make_shared<const Beginnings>());
}

Result<std::vector<std::unique_ptr<ByteSource>>> bytes_of_layers(ByteSource& file,
                                                                 const Layers& layers) {
    TESSERA_TRY_ASSIGN(Beginnings read, read_beginnings(file, layers));
    const auto shared = std::make_shared<const Beginnings>(std::move(read));
    std::vector<std::unique_ptr<ByteSource>> sources;
    for (const LayerInfo& layer : layers.further)
        sources.push_back(std::make_unique<LayerBytes>(file, layer, shared));
    return sources;
}

Result<std::vector<std::byte>> join_layers(std::span<const std::byte> first, float scale,
                                           std::span<const LayerFile> further,
                                           std::span<const DistantLight> lights) {
    TESSERA_TRY_ASSIGN(const CutFile base, cut(first));
    Layers layers;
    layers.scale = scale;
    layers.lights.assign(lights.begin(), lights.end());
    std::vector<CutFile> others;
    std::vector<std::byte> beginnings, data;
    for (const LayerFile& file : further) {
        TESSERA_TRY_ASSIGN(const CutFile other, cut(file.bytes));
        const std::size_t bytes = file.bytes.size() - other.data.size();
        append_bytes(beginnings, file.bytes.first(bytes));
        append_bytes(data, other.data);
        layers.further.push_back({.role = file.role,
                                  .scale = file.scale,
                                  .beginning_bytes = bytes,
                                  .data_bytes = other.data.size()});
    }
    const std::vector<std::byte> section = write_layers(layers);
    std::vector<std::byte> out = first_beginning(base, section, beginnings.size() + data.size());
    const std::size_t index_end = out.size();
    append_bytes(out, beginnings);
    append_bytes(out, base.data);
    append_bytes(out, data);
    const Status status = read_layers(section, index_end, out.size()).status();
    if (!status.ok())
        return Status(ErrorCode::bad_argument, status.message());
    return out;
}

} // namespace tessera
