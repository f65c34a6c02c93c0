#include "format/container/open_container.h"
#include "format/surface_mesh.h"

#include <algorithm>

namespace tessera {

namespace {

constexpr std::size_t max_findings = 1000;
constexpr std::uint64_t max_listed_boxes = 8; // in one finding
constexpr std::uint64_t most_mesh_bytes = std::uint64_t{1} << 30;

Finding finding(ContainerRule rule, bool fatal, std::string text) {
    return {.number = static_cast<int>(rule), .fatal = fatal, .text = std::move(text)};
}

// For example "tiles 3..4; tile 3 is texels 0:4,..., tile 4 is texels 4:8,...".
std::string describe_tiles(const LevelTable& table, bool aligned, std::uint64_t first,
                           std::uint64_t count) {
    std::string text = "tiles " + std::to_string(first) + ".." + std::to_string(first + count - 1);
    for (std::uint64_t i = 0; i < std::min(count, max_listed_boxes); ++i)
        text += (i == 0 ? "; tile " : ", tile ") + std::to_string(first + i) + " is texels " +
                to_string(table.box(first + i));
    if (count > max_listed_boxes)
        text += ", and so on";
    const Level& level = table.level_of(first);
    if (level.first_tile > 0)
        text += " of the coarse level " + to_string(level.size);
    if (aligned)
        text += " of the grid of aligned views";
    return text;
}

void note_unknown_values(const Description& d, const std::string& name, std::vector<Finding>& out) {
    const auto note = [&](const char* field, auto value) {
        if (!is_known(value))
            out.push_back(finding(ContainerRule::unknown_value, false,
                                  name + ": header field " + field + " has unknown value " +
                                      std::to_string(static_cast<int>(value))));
    };
    note("proxy", d.proxy);
    note("surface_map", d.surface_map);
    note("angular_map", d.angular_map);
    note("transfer", d.transfer);
    note("primaries", d.primaries);
}

void check_mesh_section(std::span<const std::byte> stream, const std::string& name,
                        std::vector<Finding>& out) {
    const Status status = decode_mesh(stream, most_mesh_bytes).status();
    if (!status)
        out.push_back(finding(ContainerRule::proxy_mesh, status.code() == ErrorCode::invalid_file,
                              name + ": section prxy: " + status.message()));
}

} // namespace

void OpenContainer::validate_head(std::vector<Finding>& out) const {
    const bool mesh = header_.description.proxy == Proxy::mesh;
    if (mesh != !section_bytes("prxy").empty())
        out.push_back(finding(ContainerRule::proxy_section, false,
                              name() + (mesh ? ": the proxy is a mesh, but section prxy is missing"
                                             : ": there is a section prxy, but the proxy is not a "
                                               "mesh")));
    else if (mesh)
        check_mesh_section(section_bytes("prxy"), name(), out);
    note_unknown_values(header_.description, name(), out);
    if (header_.optional_features != 0)
        out.push_back(finding(ContainerRule::unknown_optional, false,
                              name() + ": unknown optional features were skipped"));
    for (const SectionInfo& info : sections_)
        if (!info.known)
            out.push_back(finding(ContainerRule::unknown_optional, false,
                                  name() + ": unknown section " + info.type +
                                      at_offset(info.offset) + " was skipped"));
}

void OpenContainer::validate_group(std::uint32_t group, std::vector<Finding>& out,
                                   std::uint64_t& missing) const {
    const auto add = [&](ContainerRule rule, const Status& status, std::uint64_t first,
                         std::uint64_t count) {
        Finding result = finding(rule, true,
                                 status.message() + "; this loses " +
                                     describe_tiles(table_, header_.alignment.any(), first, count));
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

std::vector<Finding> OpenContainer::validate(const ContainerReader::Progress& progress) const {
    std::vector<Finding> out;
    validate_head(out);
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
    OpenContainer container;
    ContainerRule rule{};
    const Status status = container.load(source, options, rule);
    return status ? container.validate(progress)
                  : std::vector{finding(rule, true, status.message())};
}

} // namespace tessera
