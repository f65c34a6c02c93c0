#include "format/container/layer_table.h"
#include "format/container/open_container.h"
#include "format/io/crc32c.h"

#include <algorithm>
#include <limits>

namespace tessera {

namespace {

std::string not_tessera(std::span<const std::byte> begin) {
    const std::string kind = known_kind(begin);
    return "this is not a Tessera file" + (kind.empty() ? "" : ", but " + kind);
}

constexpr std::size_t identifier_name_bytes = 8;

// The first violation of FORMAT.md 1.2 by the section table, or "". Precondition: the types are
// valid.
std::string table_problem(std::span<const SectionEntry> entries, const FileHeader& header) {
    std::uint64_t end = header_bytes + entries.size() * section_entry_bytes;
    for (const SectionEntry& entry : entries) {
        const std::string name = "section " + entry.name();
        if (follows_head(entry.name()))
            return name + " is in the section table";
        if (end + entry.length > header.file_size)
            return name + at_offset(end) + " with " + std::to_string(entry.length) +
                   " bytes reaches past the end of the file";
        end += entry.length;
        const auto same = [&](const SectionEntry& other) { return other.type == entry.type; };
        if (std::ranges::count_if(entries, same) > 1)
            return name + " appears twice";
    }
    if (end > max_head_bytes)
        return "the sections before INDX end" + at_offset(end) + ", above the limit of " +
               std::to_string(max_head_bytes);
    if (end + header.index_size > header.file_size)
        return "section INDX" + at_offset(end) + " with " + std::to_string(header.index_size) +
               " bytes reaches past the end of the file";
    return "";
}

std::string needed_section_problem(std::span<const SectionEntry> entries,
                                   const FileHeader& header) {
    const auto has = [&](const char* type) {
        return std::ranges::any_of(entries, [&](const auto& e) { return e.name() == type; });
    };
    if (!has("CODE"))
        return "section CODE is missing";
    if (has("LEVL") != (header.level_count > 1))
        return has("LEVL") ? "there is a section LEVL, but no coarse level"
                           : "section LEVL is missing";
    return "";
}

} // namespace

std::string at_offset(std::uint64_t offset) {
    return " at offset " + std::to_string(offset);
}

Status OpenContainer::invalid(const std::string& text) const {
    return {ErrorCode::invalid_file, name() + ": " + text};
}

Status OpenContainer::load(ByteSource& source, const OpenOptions& options, ContainerRule& rule) {
    source_ = &source;
    TESSERA_TRY(load_header(options, rule));
    TESSERA_TRY(load_sections(options, rule));
    rule = ContainerRule::metadata;
    if (has_section("meta")) {
        TESSERA_TRY_ASSIGN(metadata_, unpack_metadata(section_bytes("meta")).with_context(name()));
    }
    rule = ContainerRule::layers;
    TESSERA_TRY(load_layers());
    rule = ContainerRule::geometry;
    TESSERA_TRY(load_geometry());
    rule = ContainerRule::levels;
    TESSERA_TRY(load_levels());
    rule = ContainerRule::root;
    TESSERA_TRY(load_root());
    caches_ = std::make_unique<ContainerCaches>();
    return {};
}

Status OpenContainer::load_header(const OpenOptions& options, ContainerRule& rule) {
    const std::uint64_t size = source_->size();
    rule = ContainerRule::length;
    if (size < header_bytes)
        return invalid("the file has " + std::to_string(size) + " bytes, too few for a header");
    rule = ContainerRule::readable;
    head_.resize(static_cast<std::size_t>(
        std::min(size, std::max<std::uint64_t>(source_->opening_bytes(), header_bytes))));
    TESSERA_TRY(source_->read(0, head_));

    rule = ContainerRule::identifier;
    const auto identifier = std::as_bytes(std::span(file_identifier));
    const auto [differs, _] = std::ranges::mismatch(identifier, head_);
    if (differs - identifier.begin() >= std::ptrdiff_t{identifier_name_bytes} &&
        differs != identifier.end())
        return invalid("a transfer in text mode has damaged the file");
    if (differs != identifier.end())
        return invalid(not_tessera(head_));

    rule = ContainerRule::version;
    header_ = tessera::load_header(std::span(head_).first<header_bytes>());
    if (header_.version_major != format_version_major ||
        (header_.version_minor != version_minor_plain &&
         header_.version_minor != version_minor_layers))
        return {ErrorCode::unsupported,
                name() + ": the file has format version " + std::to_string(header_.version_major) +
                    "." + std::to_string(header_.version_minor) + ", this program reads " +
                    std::to_string(format_version_major) + "." +
                    std::to_string(version_minor_plain) + " and " +
                    std::to_string(format_version_major) + "." +
                    std::to_string(version_minor_layers)};

    // The checksum covers the section table, so the length of the table must be plausible first.
    rule = ContainerRule::length;
    const std::size_t table_bytes = header_.section_count * section_entry_bytes;
    if (header_.section_count > max_sections || header_bytes + table_bytes > head_.size())
        return invalid("the section table has " + std::to_string(header_.section_count) +
                       " entries, more than the format or the file can hold");
    rule = ContainerRule::header_crc;
    const auto table = std::span(head_).subspan(header_bytes, table_bytes);
    if (crc32c(table, crc32c(std::span(head_).first<header_crc_offset>())) != header_.crc)
        return invalid("the checksum of the header is wrong");
    rule = ContainerRule::features;
    TESSERA_TRY(check_features(header_).with_context(name()));
    if (((header_.required_features & feature_layers) != 0) !=
        (header_.version_minor == version_minor_layers))
        return invalid("the feature of layers contradicts the format version");
    rule = ContainerRule::header_field;
    TESSERA_TRY(check_fields(header_).with_context(name()));
    rule = ContainerRule::file_size;
    if (header_.file_size < size || (header_.file_size > size && !options.allow_partial))
        return invalid("the file has " + std::to_string(size) + " bytes, its header says " +
                       std::to_string(header_.file_size) +
                       (size < header_.file_size ? "; it was cut off" : ""));
    return {};
}

Status OpenContainer::load_sections(const OpenOptions& options, ContainerRule& rule) {
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
                                                "\", which this version does not support"};
    rule = ContainerRule::section_table;
    for (const auto& problem :
         {table_problem(entries, header_), needed_section_problem(entries, header_)})
        if (!problem.empty())
            return invalid(problem);

    rule = ContainerRule::readable;
    list_sections(entries);
    TESSERA_TRY(load_head(options));
    rule = ContainerRule::section_crc;
    for (const SectionEntry& entry : entries)
        if (crc32c(section_bytes(entry.name())) != entry.crc)
            return invalid("the checksum of section " + entry.name() +
                           at_offset(section(entry.name()).offset) + " is wrong");
    return {};
}

void OpenContainer::list_sections(std::span<const SectionEntry> entries) {
    std::uint64_t offset = header_bytes + entries.size() * section_entry_bytes;
    const auto list = [&](const std::string& type, std::uint64_t length, bool required) {
        sections_.push_back({.type = type,
                             .offset = offset,
                             .length = length,
                             .required = required,
                             .known = is_known_section(type)});
        offset += length;
    };
    for (const SectionEntry& entry : entries)
        list(entry.name(), entry.length, entry.required());
    list("INDX", header_.index_size, true);
    list("DATA", header_.file_size - offset, true);
}

// Reads what the first read left of the head.
Status OpenContainer::load_head(const OpenOptions& options) {
    const std::uint64_t head_size = section("INDX").offset, index_end = section("DATA").offset;
    if (source_->size() < index_end)
        return invalid("only the first " + std::to_string(source_->size()) + " of " +
                       std::to_string(header_.file_size) +
                       " bytes are there; a partial file needs the index, which ends at offset " +
                       std::to_string(index_end));
    if (head_size > options.most_head_bytes)
        return {ErrorCode::over_budget,
                name() + ": the " + std::to_string(head_size) +
                    " bytes before the index must be held in memory, but only " +
                    std::to_string(options.most_head_bytes) + " are allowed"};
    if (const std::size_t have = head_.size(); have < head_size) {
        head_.resize(static_cast<std::size_t>(head_size));
        TESSERA_TRY(source_->read(have, std::span(head_).subspan(have)));
    }
    return {};
}

// DATA of a file with layers lies behind the beginnings of the others, and before their data.
Status OpenContainer::load_layers() {
    const bool claims = (header_.required_features & feature_layers) != 0;
    if (claims != has_section("LAYR"))
        return invalid(claims ? "section LAYR is missing"
                              : "there is a section LAYR, but not the feature of layers");
    if (!claims)
        return {};
    SectionInfo& data = sections_.back();
    TESSERA_TRY_ASSIGN(
        layers_,
        read_layers(section_bytes("LAYR"), data.offset, header_.file_size).with_context(name()));
    data.offset = layers_.data_offset;
    data.length = layers_.data_bytes;
    return {};
}

Status OpenContainer::load_geometry() {
    if (has_section("geom"))
        return read_geometry(section_bytes("geom"), header_.description).with_context(name());
    return is_sphere(header_.description.proxy)
               ? invalid("the proxy is a sphere, but section geom is missing")
               : Status();
}

Status OpenContainer::load_levels() {
    TESSERA_TRY_ASSIGN(
        const std::vector<LevelEntry> entries,
        read_levels(section_bytes("LEVL"), header_.level_count, aligned_views().grid_size())
            .with_context(name()));
    TESSERA_TRY_ASSIGN(table_, LevelTable::make(entries, header_.tile_extent).with_context(name()));
    return {};
}

Status OpenContainer::load_root() {
    const std::uint32_t groups = group_count();
    if (has_section("ROOT") != (groups > 1))
        return invalid(groups > 1 ? "section ROOT is missing"
                                  : "there is a section ROOT, but only one group");
    root_ = section_bytes("ROOT");
    if (root_.size() != (std::size_t{groups} - 1) * root_entry_bytes)
        return invalid("section ROOT has " + std::to_string(root_.size()) + " bytes for " +
                       std::to_string(groups) + " groups");
    RootEntry last{0, 0};
    for (std::uint32_t group = 1; group < groups; ++group) {
        const RootEntry entry = root_entry(group);
        if (entry.data < last.data || entry.index <= last.index)
            return invalid("section ROOT does not ascend at group " + std::to_string(group));
        last = entry;
    }
    if (last.data > section("DATA").length || last.index >= header_.index_size)
        return invalid("section ROOT reaches past the end of INDX or DATA");
    return {};
}

} // namespace tessera
