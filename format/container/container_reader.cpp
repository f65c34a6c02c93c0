#include "format/container_reader.h"

#include "format/container/open_container.h"

namespace tessera {

namespace {

std::vector<std::string> feature_names(std::uint64_t features) {
    std::vector<std::string> names;
    for (unsigned bit = 0; bit < 64; ++bit)
        if (features >> bit & 1)
            names.push_back(feature_name(bit));
    return names;
}

} // namespace

ContainerReader::ContainerReader(std::unique_ptr<OpenContainer> container)
    : container_(std::move(container)) {}
ContainerReader::ContainerReader(ContainerReader&&) noexcept = default;
ContainerReader& ContainerReader::operator=(ContainerReader&&) noexcept = default;
ContainerReader::~ContainerReader() = default;

Result<ContainerReader> ContainerReader::open(ByteSource& source, const OpenOptions& options) {
    auto container = std::make_unique<OpenContainer>();
    ContainerRule rule{};
    TESSERA_TRY(container->load(source, options, rule));
    return ContainerReader(std::move(container));
}

const TextureDesc& ContainerReader::desc() const {
    return header().desc;
}
const Description& ContainerReader::description() const {
    return header().description;
}
const Metadata& ContainerReader::metadata() const {
    return container_->metadata();
}
std::span<const Level> ContainerReader::levels() const {
    return level_table().levels();
}
const TileGrid& ContainerReader::grid(std::size_t level) const {
    return levels()[level].grid;
}
ViewAlignment ContainerReader::alignment() const {
    return header().alignment;
}
std::vector<std::uint64_t> ContainerReader::tiles_touched(const Box4& texels) const {
    return aligned_views().tiles_touched(grid(), texels);
}
std::uint64_t ContainerReader::tile_count() const {
    return container_->tile_count();
}
std::uint32_t ContainerReader::group_count() const {
    return container_->group_count();
}

FileFacts ContainerReader::facts() const {
    const FileHeader& h = header();
    return {.version_major = h.version_major,
            .version_minor = h.version_minor,
            .required_features = feature_names(h.required_features),
            .optional_features = feature_names(h.optional_features),
            .colour = name_of(h.colour),
            .page_bytes = h.page_bytes(),
            .background = h.background};
}

std::uint64_t ContainerReader::file_bytes() const {
    return header().file_size;
}
std::uint64_t ContainerReader::source_bytes() const {
    return container_->source().size();
}
bool ContainerReader::is_partial() const {
    return source_bytes() < file_bytes();
}
std::span<const SectionInfo> ContainerReader::sections() const {
    return container_->sections();
}
std::string ContainerReader::name() const {
    return container_->name();
}
std::span<const std::byte> ContainerReader::codec_parameters() const {
    return section_bytes("CODE");
}
std::span<const std::byte> ContainerReader::section_bytes(const std::string& type) const {
    return container_->section_bytes(type);
}
std::span<const std::byte> ContainerReader::proxy_mesh() const {
    return description().proxy == Proxy::mesh ? section_bytes("prxy")
                                              : std::span<const std::byte>();
}
const Layers& ContainerReader::layers() const {
    return container_->layers();
}
Result<TileSummary> ContainerReader::summarise_tiles() const {
    return container_->summarise_tiles();
}
const FileHeader& ContainerReader::header() const {
    return container_->header();
}
AlignedViews ContainerReader::aligned_views() const {
    return container_->aligned_views();
}
const LevelTable& ContainerReader::level_table() const {
    return container_->level_table();
}
Result<std::shared_ptr<const GroupIndex>> ContainerReader::group(std::uint32_t group) const {
    return container_->group(group);
}
Result<std::vector<std::uint64_t>> ContainerReader::nonempty_tiles(std::uint32_t group) const {
    return container_->nonempty_tiles(group);
}
Result<bool> ContainerReader::is_received(std::uint64_t tile) const {
    return container_->is_received(tile);
}
Result<TileLocation> ContainerReader::locate(std::uint64_t tile) const {
    return container_->locate(tile);
}

bool ContainerReader::is_empty(std::uint64_t tile) const {
    const Result<TileLocation> location = locate(tile);
    return location && location->length == 0;
}
Status ContainerReader::read_tile(std::uint64_t tile, std::vector<std::byte>& out) const {
    return container_->read_tile(tile, out);
}
Result<TileBytes> ContainerReader::load_tile(std::uint64_t tile) const {
    return container_->load_tile(tile);
}
Status ContainerReader::read_tile_checked(std::uint64_t tile, std::vector<std::byte>& out) const {
    TESSERA_TRY_ASSIGN(const TileBytes loaded, load_tile(tile));
    out.assign(loaded.bytes.begin(), loaded.bytes.end());
    return {};
}
Result<std::size_t> ContainerReader::prefetch(std::span<const std::uint64_t> tiles) const {
    return container_->prefetch(tiles);
}
Result<std::uint32_t> ContainerReader::prefetch_groups(std::uint32_t first) const {
    return container_->prefetch_groups(first);
}
bool ContainerReader::wants_prefetch() const {
    return container_->source().wants_prefetch();
}
std::vector<Finding> ContainerReader::validate(const Progress& progress) const {
    return container_->validate(progress);
}

} // namespace tessera
