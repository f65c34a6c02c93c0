#include "format/container_reader.h"

#include "format/bytes.h"
#include "format/container_caches.h"
#include "format/crc32c.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace tessera {

namespace {

constexpr std::size_t max_findings = 1000;
constexpr std::uint64_t max_listed_boxes = 8; // in one finding
constexpr std::size_t identifier_name_bytes = 8;

std::string at_offset(std::uint64_t offset) {
    return " at offset " + std::to_string(offset);
}

// The first break of the order and number of sections that 1.2 asks for, or "". The caller checks
// the types first.
std::string table_problem(std::span<const SectionEntry> entries, const FileHeader& header) {
    std::uint64_t expected = header_bytes + entries.size() * section_entry_bytes;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const SectionEntry& entry = entries[i];
        const std::string name = "section " + entry.name();
        if (entry.offset != expected)
            return name + " starts" + at_offset(entry.offset) + " instead of " +
                   std::to_string(expected);
        if (entry.length > header.file_size - expected)
            return name + at_offset(entry.offset) + " with " + std::to_string(entry.length) +
                   " bytes reaches past the end of the file";
        expected += entry.length;
        const auto same = [&](const SectionEntry& other) { return other.type == entry.type; };
        if (std::ranges::count_if(entries, same) > 1)
            return name + " stands twice";
    }
    if (expected != header.file_size)
        return "the sections end" + at_offset(expected) + ", the file has " +
               std::to_string(header.file_size) + " bytes";
    return "";
}

std::string needed_section_problem(std::span<const SectionEntry> entries,
                                   const FileHeader& header) {
    for (const char* type : {"CODE", "LEVL", "ROOT", "INDX", "DATA"})
        if (std::ranges::none_of(entries, [&](const auto& e) { return e.name() == type; }))
            return std::string("section ") + type + " is missing";
    const SectionEntry& index = entries[entries.size() - 2];
    const SectionEntry& data = entries.back();
    if (index.name() != "INDX" || data.name() != "DATA")
        return "the last sections are not INDX and DATA";
    if (index.crc != 0 || data.crc != 0)
        return "INDX and DATA have checksums in the section table";
    if (index.offset != header.head_size)
        return "header field head_size is " + std::to_string(header.head_size) + ", INDX starts" +
               at_offset(index.offset);
    if (index.length > std::numeric_limits<std::uint32_t>::max())
        return "section INDX has " + std::to_string(index.length) + " bytes, more than 2^32 - 1";
    return "";
}

} // namespace

ContainerReader::ContainerReader() = default;
ContainerReader::ContainerReader(ContainerReader&&) noexcept = default;
ContainerReader& ContainerReader::operator=(ContainerReader&&) noexcept = default;
ContainerReader::~ContainerReader() = default;

// ---------------------------------------------------------------- opening

Result<ContainerReader> ContainerReader::open(ByteSource& source, const OpenOptions& options) {
    ContainerReader reader;
    ContainerRule rule{};
    TESSERA_TRY(reader.load(source, options, rule));
    return reader;
}

Status ContainerReader::invalid(const std::string& text) const {
    return {ErrorCode::invalid_file, name() + ": " + text};
}

Status ContainerReader::load(ByteSource& source, const OpenOptions& options, ContainerRule& rule) {
    source_ = &source;
    TESSERA_TRY(load_header(options, rule));
    TESSERA_TRY(load_sections(rule));
    rule = ContainerRule::metadata;
    if (std::ranges::find(sections_, "meta", &SectionInfo::type) != sections_.end()) {
        Result<Metadata> metadata = unpack_metadata(section_bytes("meta"));
        TESSERA_TRY(metadata.status().with_context(name()));
        metadata_ = std::move(*metadata);
    }
    rule = ContainerRule::levels;
    TESSERA_TRY(load_levels());
    rule = ContainerRule::root;
    TESSERA_TRY(load_root());
    caches_ = std::make_unique<Caches>();
    return {};
}

Status ContainerReader::load_header(const OpenOptions& options, ContainerRule& rule) {
    const std::uint64_t size = source_->size();
    rule = ContainerRule::length;
    if (size < header_bytes)
        return invalid("the file has " + std::to_string(size) + " bytes, too few for a header");
    rule = ContainerRule::readable;
    head_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, first_read_bytes)));
    TESSERA_TRY(source_->read(0, head_));

    rule = ContainerRule::identifier;
    const auto identifier = std::as_bytes(std::span(file_identifier));
    const auto [differs, _] = std::ranges::mismatch(identifier, head_);
    if (differs - identifier.begin() >= std::ptrdiff_t{identifier_name_bytes} &&
        differs != identifier.end())
        return invalid("the file was damaged by a transfer as text");
    if (differs != identifier.end())
        return invalid("this is not a Tessera file");

    rule = ContainerRule::version;
    header_ = tessera::load_header(std::span(head_).first<header_bytes>());
    if (header_.version_major != format_version_major ||
        header_.version_minor != format_version_minor)
        return {ErrorCode::unsupported,
                name() + ": the file has format version " + std::to_string(header_.version_major) +
                    "." + std::to_string(header_.version_minor) + ", this program reads " +
                    std::to_string(format_version_major) + "." +
                    std::to_string(format_version_minor)};

    // Without a believable table length there is no checksum to check.
    rule = ContainerRule::length;
    const std::size_t table_bytes = header_.section_count * section_entry_bytes;
    if (header_.section_count > max_sections || header_bytes + table_bytes > head_.size())
        return invalid("the section table of " + std::to_string(header_.section_count) +
                       " entries does not fit the format or the file");
    rule = ContainerRule::header_crc;
    const auto table = std::span(head_).subspan(header_bytes, table_bytes);
    if (crc32c(table, crc32c(std::span(head_).first<header_crc_offset>())) != header_.crc)
        return invalid("the checksum of the header is wrong");
    rule = ContainerRule::features;
    TESSERA_TRY(check_features(header_).with_context(name()));
    rule = ContainerRule::header_field;
    TESSERA_TRY(check_fields(header_).with_context(name()));
    rule = ContainerRule::file_size;
    if (header_.file_size < size || (header_.file_size > size && !options.allow_partial))
        return invalid("the file has " + std::to_string(size) + " bytes, its header says " +
                       std::to_string(header_.file_size) +
                       (size < header_.file_size ? "; it was cut off" : ""));
    return {};
}

Status ContainerReader::load_sections(ContainerRule& rule) {
    rule = ContainerRule::section_table;
    std::vector<SectionEntry> entries;
    for (std::size_t i = 0; i < header_.section_count; ++i) {
        const std::size_t at = header_bytes + i * section_entry_bytes;
        entries.push_back(load_section(std::span(head_).subspan(at).first<section_entry_bytes>()));
        if (!is_section_type(entries.back().name()))
            return invalid("section " + std::to_string(i) + " has a type that is not four letters");
    }
    rule = ContainerRule::section_known;
    for (const SectionEntry& entry : entries)
        if (entry.required() && !is_known_section(entry.name()))
            return {ErrorCode::unsupported, name() + ": the file needs section \"" + entry.name() +
                                                "\", which this version does not have"};
    rule = ContainerRule::section_table;
    for (const auto& problem :
         {table_problem(entries, header_), needed_section_problem(entries, header_)})
        if (!problem.empty())
            return invalid(problem);

    rule = ContainerRule::readable;
    const std::uint64_t index_end = header_.head_size + entries[entries.size() - 2].length;
    if (source_->size() < index_end)
        return invalid("of " + std::to_string(header_.file_size) + " bytes the first " +
                       std::to_string(source_->size()) +
                       " are here; the index, which a part of a file needs, ends at " +
                       std::to_string(index_end));
    if (const std::size_t have = head_.size(); have < header_.head_size) {
        head_.resize(header_.head_size);
        TESSERA_TRY(source_->read(have, std::span(head_).subspan(have)));
    }
    rule = ContainerRule::section_crc;
    for (const SectionEntry& entry : entries) {
        sections_.push_back({entry.name(), entry.offset, entry.length, entry.required(),
                             is_known_section(entry.name())});
        const bool own_checksums = entry.name() == "INDX" || entry.name() == "DATA";
        if (!own_checksums && crc32c(section_bytes(entry.name())) != entry.crc)
            return invalid("the checksum of section " + entry.name() + at_offset(entry.offset) +
                           " is wrong");
    }
    return {};
}

Status ContainerReader::load_levels() {
    const std::span<const std::byte> bytes = section_bytes("LEVL");
    if (bytes.size() != header_.level_count * level_entry_bytes)
        return invalid("section LEVL has " + std::to_string(bytes.size()) + " bytes for " +
                       std::to_string(header_.level_count) + " level");
    const Result<std::vector<LevelEntry>> entries = read_levels(bytes);
    TESSERA_TRY(entries.status().with_context(name()));
    if (entries->front().size != header_.desc.size)
        return invalid("section LEVL does not start with the texture itself");
    Result<LevelTable> table = LevelTable::make(*entries, header_.tile_extent);
    TESSERA_TRY(table.status().with_context(name()));
    table_ = std::move(*table);
    return {};
}

Status ContainerReader::load_root() {
    root_ = section_bytes("ROOT");
    const std::uint32_t groups = group_count();
    if (root_.size() != (std::size_t{groups} + 1) * root_entry_bytes)
        return invalid("section ROOT has " + std::to_string(root_.size()) + " bytes for " +
                       std::to_string(groups) + " groups");
    const SectionInfo& index = section("INDX");
    const SectionInfo& data = section("DATA");
    const RootEntry first = root(0), last = root(groups);
    if (first.data != data.offset || first.index != index.offset ||
        last.data != data.offset + data.length || last.index != index.offset + index.length)
        return invalid("section ROOT does not span INDX and DATA");
    for (std::uint32_t group = 0; group < groups; ++group)
        if (root(group).data > root(group + 1).data || root(group).index >= root(group + 1).index)
            return invalid("entry " + std::to_string(group + 1) +
                           " of section ROOT does not ascend");
    return {};
}

// ---------------------------------------------------------------- finding

const SectionInfo& ContainerReader::section(const std::string& type) const {
    return *std::ranges::find(sections_, type, &SectionInfo::type);
}

std::span<const std::byte> ContainerReader::section_bytes(const std::string& type) const {
    const auto found = std::ranges::find(sections_, type, &SectionInfo::type);
    if (found == sections_.end() || found->offset + found->length > head_.size())
        return {};
    return std::span(head_).subspan(static_cast<std::size_t>(found->offset),
                                    static_cast<std::size_t>(found->length));
}

ContainerReader::RootEntry ContainerReader::root(std::uint32_t group) const {
    const std::byte* at = root_.data() + std::size_t{group} * root_entry_bytes;
    return {load_le<std::uint64_t>(at),
            std::uint64_t{header_.head_size} + load_le<std::uint32_t>(at + 8)};
}

GroupKey ContainerReader::group_key(std::uint32_t group) const {
    return {header_.identity,
            group,
            table_.tiles_of(group).count,
            root(group).data,
            root(group + 1).data,
            header_.page_bytes()};
}

ContainerReader::IndexRange ContainerReader::index_range(std::uint32_t group) const {
    const std::uint64_t begin = root(group).index;
    return {begin, root(group + 1).index - begin};
}

Result<GroupIndex> ContainerReader::read_group(std::uint32_t group, ContainerRule& rule) const {
    const IndexRange range = index_range(group);
    rule = ContainerRule::index_record;
    if (range.length > max_index_record_bytes(group_key(group)))
        return invalid("index record of group " + std::to_string(group) + at_offset(range.offset) +
                       ": " + std::to_string(range.length) + " bytes are too many");
    std::vector<std::byte> bytes(static_cast<std::size_t>(range.length));
    rule = ContainerRule::readable;
    TESSERA_TRY(read_bytes(range.offset, bytes));
    return parse_group(group, bytes, rule);
}

Result<GroupIndex> ContainerReader::parse_group(std::uint32_t group,
                                                std::span<const std::byte> bytes,
                                                ContainerRule& rule) const {
    bool crc_error = false;
    Result<GroupIndex> index = read_index_record(bytes, group_key(group), &crc_error);
    rule = crc_error ? ContainerRule::index_crc : ContainerRule::index_record;
    TESSERA_TRY(index.status().with_context(name() + ": index record of group " +
                                            std::to_string(group) +
                                            at_offset(index_range(group).offset)));
    return index;
}

Result<std::shared_ptr<const GroupIndex>> ContainerReader::group(std::uint32_t group) const {
    if (group >= group_count())
        return Status(ErrorCode::bad_argument, name() + ": there is no tile group " +
                                                   std::to_string(group) + ", only " +
                                                   std::to_string(group_count()));
    return caches_->groups.get(group, [&] {
        ContainerRule rule{};
        return read_group(group, rule);
    });
}

// ---------------------------------------------------------------- tiles

Status ContainerReader::no_such_tile(std::uint64_t tile) const {
    return {ErrorCode::bad_argument, name() + ": there is no tile " + std::to_string(tile) +
                                         ", only " + std::to_string(tile_count())};
}

Result<ContainerReader::Place> ContainerReader::place_of(std::uint64_t tile) const {
    if (tile >= tile_count())
        return no_such_tile(tile);
    Place place;
    place.group = table_.group_of(tile);
    auto index = group(place.group);
    TESSERA_TRY(index.status());
    place.index = *index;
    const std::uint64_t at = tile - table_.tiles_of(place.group).first;
    place.begin = place.index->starts[at];
    place.end = place.index->starts[at + 1];
    return place;
}

Result<TileLocation> ContainerReader::locate(std::uint64_t tile) const {
    const Result<Place> place = place_of(tile);
    TESSERA_TRY(place.status());
    return TileLocation{place->begin, static_cast<std::uint32_t>(place->end - place->begin)};
}

Result<bool> ContainerReader::is_received(std::uint64_t tile) const {
    const Result<Place> place = place_of(tile);
    TESSERA_TRY(place.status());
    const auto [begin, end] = place->index->pages_of(place->begin, place->end);
    if (begin == end)
        return true;
    const Page& last = place->index->pages[end - 1];
    return last.offset + last.length <= source_->size();
}

Status ContainerReader::read_bytes(std::uint64_t offset, std::span<std::byte> out) const {
    if (!is_at_hand(offset, out.size()))
        return source_->read(offset, out);
    std::ranges::copy(std::span(head_).subspan(static_cast<std::size_t>(offset), out.size()),
                      out.begin());
    return {};
}

Status ContainerReader::read_tile(std::uint64_t tile, std::vector<std::byte>& out) const {
    const Result<TileLocation> location = locate(tile);
    TESSERA_TRY(location.status());
    out.resize(location->length);
    return out.empty() ? Status() : read_bytes(location->offset, out);
}

Status ContainerReader::check_page(std::uint32_t group, std::size_t number, const Page& page,
                                   std::span<const std::byte> bytes) const {
    if (page_crc(header_.identity, group, static_cast<std::uint32_t>(number), bytes) == page.crc)
        return {};
    return invalid("page " + std::to_string(number) + " of group " + std::to_string(group) +
                   at_offset(page.offset) + " (" + std::to_string(page.length) +
                   " bytes): its checksum is wrong");
}

Result<std::vector<std::byte>> ContainerReader::read_page(std::uint32_t group, std::size_t number,
                                                          const Page& page) const {
    std::vector<std::byte> bytes(page.length);
    TESSERA_TRY(read_bytes(page.offset, bytes));
    TESSERA_TRY(check_page(group, number, page, bytes));
    return bytes;
}

Result<TileBytes> ContainerReader::load_tile(std::uint64_t tile) const {
    const Result<Place> place = place_of(tile);
    TESSERA_TRY(place.status());
    const GroupIndex::PageRange range = place->index->pages_of(place->begin, place->end);
    if (range.begin == range.end)
        return TileBytes{};
    if (range.end - range.begin > 1)
        return load_large_tile(*place, range);
    const Page& page = place->index->pages[range.begin];
    auto bytes =
        caches_->pages.get(page.offset, [&] { return read_page(place->group, range.begin, page); });
    TESSERA_TRY(bytes.status());
    const std::span<const std::byte> whole = **bytes;
    return TileBytes{*bytes, whole.subspan(static_cast<std::size_t>(place->begin - page.offset),
                                           static_cast<std::size_t>(place->end - place->begin))};
}

// The bytes of `pages`, which follow each other.
Status ContainerReader::check_pages(const Place& place, const GroupIndex::PageRange& pages,
                                    std::span<const std::byte> bytes) const {
    for (std::size_t number = pages.begin; number < pages.end; ++number) {
        const Page& page = place.index->pages[number];
        TESSERA_TRY(check_page(place.group, number, page, bytes.first(page.length)));
        bytes = bytes.subspan(page.length);
    }
    return {};
}

// A tile of several pages shares none of them: one read brings all, and they are kept as one.
Result<TileBytes> ContainerReader::load_large_tile(const Place& place,
                                                   const GroupIndex::PageRange& pages) const {
    auto bytes = caches_->pages.get(place.begin, [&]() -> Result<std::vector<std::byte>> {
        std::vector<std::byte> read(static_cast<std::size_t>(place.end - place.begin));
        TESSERA_TRY(source_->read(place.begin, read));
        TESSERA_TRY(check_pages(place, pages, read));
        return read;
    });
    TESSERA_TRY(bytes.status());
    return TileBytes{*bytes, **bytes};
}

Status ContainerReader::read_tile_checked(std::uint64_t tile, std::vector<std::byte>& out) const {
    const Result<TileBytes> loaded = load_tile(tile);
    TESSERA_TRY(loaded.status());
    out.assign(loaded->bytes.begin(), loaded->bytes.end());
    return {};
}

// ---------------------------------------------------------------- validation

namespace {

Finding finding(ContainerRule rule, bool fatal, std::string text) {
    return {static_cast<int>(rule), fatal, std::move(text), 0, 0};
}

// "tiles 3..4; tile 3 is texels 0:4,..., tile 4 is texels 4:8,..."
std::string describe_tiles(const LevelTable& table, std::uint64_t first, std::uint64_t count) {
    std::string text = "tiles " + std::to_string(first) + ".." + std::to_string(first + count - 1);
    for (std::uint64_t i = 0; i < std::min(count, max_listed_boxes); ++i)
        text += (i == 0 ? "; tile " : ", tile ") + std::to_string(first + i) + " is texels " +
                to_string(table.box(first + i));
    if (count > max_listed_boxes)
        text += ", and so on";
    const Level& level = table.level_of(first);
    if (level.first_tile > 0)
        text += " of the coarse level " + to_string(level.size);
    return text;
}

void note_unknown_values(const Description& d, const std::string& name, std::vector<Finding>& out) {
    const auto note = [&](const char* field, int value, int largest) {
        if (value > largest)
            out.push_back(finding(ContainerRule::unknown_value, false,
                                  name + ": header field " + field + " has unknown value " +
                                      std::to_string(value)));
    };
    note("proxy", static_cast<int>(d.proxy), 2);
    note("surface_map", static_cast<int>(d.surface_map), 2);
    note("angular_map", static_cast<int>(d.angular_map), 2);
    note("transfer", static_cast<int>(d.transfer), 2);
    note("primaries", static_cast<int>(d.primaries), 1);
}

} // namespace

void ContainerReader::note_curiosities(std::vector<Finding>& out) const {
    const bool mesh = description().proxy == Proxy::mesh;
    if (mesh != !section_bytes("prxy").empty())
        out.push_back(finding(ContainerRule::proxy_section, false,
                              name() + (mesh ? ": the proxy is a mesh, but section prxy is missing"
                                             : ": section prxy without a mesh as proxy")));
    note_unknown_values(description(), name(), out);
    if (header_.optional_features != 0)
        out.push_back(finding(ContainerRule::unknown_optional, false,
                              name() + ": unknown optional features were skipped"));
    for (const SectionInfo& info : sections_)
        if (!info.known)
            out.push_back(finding(ContainerRule::unknown_optional, false,
                                  name() + ": unknown section " + info.type +
                                      at_offset(info.offset) + " was skipped"));
}

void ContainerReader::validate_group(std::uint32_t group, std::vector<Finding>& out,
                                     std::uint64_t& missing) const {
    const auto add = [&](ContainerRule rule, const Status& status, std::uint64_t first,
                         std::uint64_t count) {
        Finding result = finding(
            rule, true, status.message() + "; lost are " + describe_tiles(table_, first, count));
        result.first_tile = first;
        result.tile_count = count;
        out.push_back(std::move(result));
    };
    const std::uint64_t first_tile = table_.tiles_of(group).first;
    ContainerRule rule{};
    const Result<GroupIndex> index = read_group(group, rule);
    if (!index)
        return add(rule, index.status(), first_tile, group_key(group).tiles);
    for (std::size_t number = 0; number < index->pages.size(); ++number) {
        const Page& page = index->pages[number];
        const auto [begin, end] = index->tiles_of(page);
        if (page.offset + page.length > source_->size()) {
            missing += end - begin;
            continue;
        }
        const Status status = read_page(group, number, page).status();
        if (!status)
            add(status.code() == ErrorCode::io ? ContainerRule::readable : ContainerRule::page_crc,
                status, first_tile + begin, end - begin);
        if (out.size() > max_findings)
            return;
    }
}

std::vector<Finding> ContainerReader::validate(const Progress& progress) const {
    std::vector<Finding> out;
    note_curiosities(out);
    const SectionInfo& data = section("DATA");
    std::uint64_t missing = 0;
    for (std::uint32_t group = 0; group < group_count() && out.size() <= max_findings; ++group) {
        validate_group(group, out, missing);
        if (progress)
            progress(static_cast<double>(root(group + 1).data - data.offset),
                     static_cast<double>(data.length));
    }
    if (missing > 0)
        out.push_back(finding(ContainerRule::not_received, false,
                              name() + ": " + std::to_string(missing) + " of " +
                                  std::to_string(tile_count()) + " tiles have not been received"));
    if (out.size() > max_findings) {
        out.resize(max_findings);
        out.push_back(finding(ContainerRule::more, true,
                              name() + ": more than " + std::to_string(max_findings) +
                                  " findings; the check stopped"));
    }
    return out;
}

std::vector<Finding> validate_container(ByteSource& source,
                                        const ContainerReader::Progress& progress,
                                        const OpenOptions& options) {
    ContainerReader reader;
    ContainerRule rule{};
    const Status status = reader.load(source, options, rule);
    return status ? reader.validate(progress) : std::vector{finding(rule, true, status.message())};
}

} // namespace tessera
