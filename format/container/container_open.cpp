#include "format/container/open_container.h"
#include "format/io/crc32c.h"

#include <algorithm>
#include <limits>

namespace tessera {

namespace {

constexpr std::size_t identifier_name_bytes = 8;

// The first violation of the order, the offsets or the uniqueness of sections (FORMAT.md 1.2), or
// "". Precondition: the types are valid.
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
            return name + " appears twice";
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
    if (std::ranges::find(sections_, "meta", &SectionInfo::type) != sections_.end()) {
        TESSERA_TRY_ASSIGN(metadata_, unpack_metadata(section_bytes("meta")).with_context(name()));
    }
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
    head_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, first_read_bytes)));
    TESSERA_TRY(source_->read(0, head_));

    rule = ContainerRule::identifier;
    const auto identifier = std::as_bytes(std::span(file_identifier));
    const auto [differs, _] = std::ranges::mismatch(identifier, head_);
    if (differs - identifier.begin() >= std::ptrdiff_t{identifier_name_bytes} &&
        differs != identifier.end())
        return invalid("a transfer in text mode has damaged the file");
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
    const std::uint64_t index_end = header_.head_size + entries[entries.size() - 2].length;
    if (source_->size() < index_end)
        return invalid("only the first " + std::to_string(source_->size()) + " of " +
                       std::to_string(header_.file_size) +
                       " bytes are there; a partial file needs the index, which ends at offset " +
                       std::to_string(index_end));
    if (header_.head_size > options.most_head_bytes)
        return {ErrorCode::over_budget,
                name() + ": the " + std::to_string(header_.head_size) +
                    " bytes before the index must be held in memory, but only " +
                    std::to_string(options.most_head_bytes) + " are allowed"};
    if (const std::size_t have = head_.size(); have < header_.head_size) {
        head_.resize(header_.head_size);
        TESSERA_TRY(source_->read(have, std::span(head_).subspan(have)));
    }
    rule = ContainerRule::section_crc;
    for (const SectionEntry& entry : entries) {
        sections_.push_back({.type = entry.name(),
                             .offset = entry.offset,
                             .length = entry.length,
                             .required = entry.required(),
                             .known = is_known_section(entry.name())});
        const bool own_checksums = entry.name() == "INDX" || entry.name() == "DATA";
        if (!own_checksums && crc32c(section_bytes(entry.name())) != entry.crc)
            return invalid("the checksum of section " + entry.name() + at_offset(entry.offset) +
                           " is wrong");
    }
    return {};
}

Status OpenContainer::load_levels() {
    const std::span<const std::byte> bytes = section_bytes("LEVL");
    if (bytes.size() != header_.level_count * level_entry_bytes)
        return invalid("section LEVL has " + std::to_string(bytes.size()) + " bytes for " +
                       std::to_string(header_.level_count) + " levels");
    TESSERA_TRY_ASSIGN(const std::vector<LevelEntry> entries,
                       read_levels(bytes).with_context(name()));
    if (entries.front().size != aligned_views().grid_size())
        return invalid("section LEVL does not start with the texture itself");
    TESSERA_TRY_ASSIGN(table_, LevelTable::make(entries, header_.tile_extent).with_context(name()));
    return {};
}

Status OpenContainer::load_root() {
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

} // namespace tessera
