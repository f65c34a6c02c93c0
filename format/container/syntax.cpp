#include "format/container/syntax.h"

#include "format/io/bytes.h"
#include "format/levels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

namespace tessera {

namespace {

// These two read and write fields one after the other. walk_header() gives their order.
class FieldReader {
public:
    explicit FieldReader(const std::byte* at) : at_(at) {}
    template <std::unsigned_integral T> void field(T& value) {
        value = load_le<T>(at_);
        at_ += sizeof(T);
    }

private:
    const std::byte* at_;
};

class FieldWriter {
public:
    explicit FieldWriter(std::byte* at) : at_(at) {}
    template <std::unsigned_integral T> void field(T value) {
        store_le(at_, value);
        at_ += sizeof(T);
    }

private:
    std::byte* at_;
};

// One list of the fields of FORMAT.md 1.1 serves both directions, so that they cannot disagree.
// `Fields` is FieldReader with a mutable header, or FieldWriter with a const header.
template <class Fields, class Header> void walk_header(Fields& fields, Header& h) {
    const auto as = [&]<class Raw>(Raw, auto& value) {
        auto raw = static_cast<Raw>(value);
        fields.field(raw);
        if constexpr (!std::is_const_v<Header>)
            value = static_cast<std::remove_reference_t<decltype(value)>>(raw);
    };
    const auto byte_enum = [&](auto& value) { as(std::uint8_t{}, value); };
    fields.field(h.version_major);
    fields.field(h.version_minor);
    as(std::uint32_t{}, h.required_features);
    as(std::uint32_t{}, h.optional_features);
    fields.field(h.file_size);
    fields.field(h.index_size);
    fields.field(h.section_count);
    fields.field(h.level_count);
    fields.field(h.page_target);
    for (auto& extent : h.desc.size)
        fields.field(extent);
    for (auto& extent : h.tile_extent) {
        auto raw = static_cast<std::uint8_t>(extent - 1);
        fields.field(raw);
        if constexpr (!std::is_const_v<Header>)
            extent = raw + 1u;
    }
    byte_enum(h.desc.type);
    fields.field(h.desc.channels);
    byte_enum(h.colour);
    byte_enum(h.description.alpha);
    byte_enum(h.description.proxy);
    byte_enum(h.description.surface_map);
    byte_enum(h.description.angular_map);
    byte_enum(h.description.transfer);
    byte_enum(h.description.primaries);
    fields.field(h.reserved);
    auto align_u = static_cast<std::uint8_t>(h.alignment.u);
    auto align_v = static_cast<std::uint8_t>(h.alignment.v);
    fields.field(align_u);
    fields.field(align_v);
    for (auto& value : h.background)
        fields.field(value);
    fields.field(h.identity);
    fields.field(h.crc);
    if constexpr (!std::is_const_v<Header>)
        h.alignment = {static_cast<std::int8_t>(align_u), static_cast<std::int8_t>(align_v)};
}

Status check_range(const char* field, std::uint64_t value, std::uint64_t low, std::uint64_t high) {
    if (low <= value && value <= high)
        return {};
    return invalid(std::string("header field ") + field + " is " + std::to_string(value) +
                   ", outside " + std::to_string(low) + ".." + std::to_string(high));
}

Status check_alignment(const FileHeader& h) {
    if (h.alignment.any() != ((h.required_features & feature_aligned) != 0))
        return invalid("header fields align_u and align_v contradict the feature of aligned views");
    if (!h.alignment.any())
        return {};
    if (h.level_count > 1 || h.description.proxy != Proxy::none)
        return invalid(
            "header fields align_u and align_v: aligned views allow neither coarse levels nor a "
            "proxy");
    TextureDesc grid = h.desc;
    grid.size = AlignedViews(h.desc.size, h.alignment).grid_size();
    const Status status = check_desc(grid);
    return status.ok() ? Status()
                       : invalid("header fields align_u and align_v: " + status.message());
}

Status check_tile_extent(const FileHeader& h) {
    for (std::size_t axis = 0; axis < 4; ++axis)
        TESSERA_TRY(check_range("tile_extent", h.tile_extent[axis], 1,
                                static_cast<std::uint64_t>(max_side_along(axis))));
    const bool corrects = (h.required_features & feature_corrections) != 0;
    return check_range("tile_extent (product)", texel_count(h.tile_extent), 1,
                       static_cast<std::uint64_t>(max_texels_of_tile(corrects)));
}

Status check_channel_use(const FileHeader& h) {
    TESSERA_TRY(check_range("colour", static_cast<std::uint8_t>(h.colour), 0, 1));
    if (h.colour == ColourTransform::ycocg_r && h.desc.channels < 3)
        return invalid("header field colour is YCoCg-R with " + std::to_string(h.desc.channels) +
                       " channels");
    const AlphaMode alpha = h.description.alpha;
    TESSERA_TRY(check_range("alpha", static_cast<std::uint8_t>(alpha), 0,
                            value_names<AlphaMode>.size() - 1));
    if (alpha != AlphaMode::none && h.desc.channels % 2 != 0)
        return invalid(std::string("header field alpha is ") + name_of(alpha) + " with " +
                       std::to_string(h.desc.channels) + " channels");
    return {};
}

Status check_background(const FileHeader& h) {
    for (std::size_t channel = 0; channel < h.background.size(); ++channel) {
        const std::uint16_t sample = h.background[channel];
        if (channel < h.desc.channels ? !has_code(sample, h.desc.type) : sample != 0)
            return invalid("header field background[" + std::to_string(channel) + "] is " +
                           std::to_string(sample) + ", not a sample of this texture");
    }
    return {};
}

// Calls visit(number) for the numbers of section geom in order.
template <class SomeDescription, class Visit> void walk_geometry(SomeDescription& d, Visit visit) {
    for (auto& value : d.sphere_centre)
        visit(value);
    visit(d.sphere_radius);
    for (auto& value : d.viewing_radius)
        visit(value);
}

bool has_geometry(const Description& d) {
    bool any = false;
    walk_geometry(d, [&any](float value) { any = any || value != 0; });
    return any;
}

} // namespace

std::string feature_name(unsigned bit) {
    constexpr const char* names[] = {"coarse levels",
                                     "corrections",
                                     "quality layers",
                                     "colour rotation per leaf",
                                     "prediction inside tiles",
                                     "stored tiles",
                                     "aligned views",
                                     "layers",
                                     "axes without a transform",
                                     "transforms of blocks without a first plane",
                                     "a split tree for each plane"};
    return bit < std::size(names) ? names[bit] : "bit " + std::to_string(bit);
}

FileHeader load_header(std::span<const std::byte, header_bytes> bytes) {
    FileHeader header;
    FieldReader fields(bytes.data() + file_identifier.size());
    walk_header(fields, header);
    return header;
}

std::array<std::byte, header_bytes> store_header(const FileHeader& header) {
    std::array<std::byte, header_bytes> bytes;
    std::ranges::copy(std::as_bytes(std::span(file_identifier)), bytes.begin());
    FieldWriter fields(bytes.data() + file_identifier.size());
    walk_header(fields, header);
    return bytes;
}

Status check_features(const FileHeader& header) {
    const std::uint64_t unknown = header.required_features & ~known_features;
    if (unknown == 0)
        return {};
    const auto bit = static_cast<unsigned>(std::countr_zero(unknown));
    return {ErrorCode::unsupported, "the file needs feature \"" + feature_name(bit) + "\" (bit " +
                                        std::to_string(bit) +
                                        " of required_features), which this version does not "
                                        "support"};
}

Status check_fields(const FileHeader& h) {
    TESSERA_TRY(check_range("sample_type", static_cast<std::uint8_t>(h.desc.type), 0,
                            sample_types.size() - 1));
    if (const Status status = check_desc(h.desc); !status)
        return invalid("header field size or channels: " + status.message());
    TESSERA_TRY(check_range("section_count", h.section_count, min_sections, max_sections));
    TESSERA_TRY(check_range("page_target", h.page_target, 0, max_page_target));
    TESSERA_TRY(check_tile_extent(h));
    TESSERA_TRY(check_channel_use(h));
    const bool levels = (h.required_features & feature_levels) != 0;
    TESSERA_TRY(check_range("level_count", h.level_count, levels ? 2 : 1, levels ? max_levels : 1));
    TESSERA_TRY(check_alignment(h));
    TESSERA_TRY(check_range("reserved", h.reserved, 0, 0));
    return check_background(h);
}

Status check_geometry(const Description& d) {
    if (!std::ranges::all_of(d.sphere_centre, [](float x) { return std::isfinite(x); }))
        return invalid("sphere_centre is not finite");
    const bool sphere = is_sphere(d.proxy);
    if (!std::isfinite(d.sphere_radius) || (sphere ? !(d.sphere_radius > 0) : d.sphere_radius != 0))
        return invalid(std::string("sphere_radius is not ") +
                       (sphere ? "above 0" : "0 without a sphere"));
    const auto [near, far] = std::pair(d.viewing_radius[0], d.viewing_radius[1]);
    if (!std::isfinite(near) || !std::isfinite(far) || near < 0 || near > far)
        return invalid("viewing_radius is not 0 <= near <= far");
    return {};
}

std::vector<std::byte> write_geometry(const Description& description) {
    std::vector<std::byte> section;
    if (has_geometry(description))
        walk_geometry(description, [&section](float value) {
            append_le(section, std::bit_cast<std::uint32_t>(value));
        });
    return section;
}

Status read_geometry(std::span<const std::byte> section, Description& description) {
    if (section.size() != geometry_bytes)
        return invalid("section geom has " + std::to_string(section.size()) + " bytes instead of " +
                       std::to_string(geometry_bytes));
    walk_geometry(description, [at = section.data()](float& value) mutable {
        value = std::bit_cast<float>(load_le<std::uint32_t>(at));
        at += sizeof value;
    });
    if (const Status status = check_geometry(description); !status)
        return invalid("section geom: " + status.message());
    return has_geometry(description) ? Status()
                                     : invalid("section geom has no number other than 0");
}

SectionEntry load_section(std::span<const std::byte, section_entry_bytes> bytes) {
    SectionEntry entry;
    for (std::size_t i = 0; i < entry.type.size(); ++i)
        entry.type[i] = std::to_integer<char>(bytes[i]);
    entry.crc = load_le<std::uint32_t>(bytes.data() + 4);
    entry.length = load_le<std::uint32_t>(bytes.data() + 8);
    return entry;
}

std::array<std::byte, section_entry_bytes> store_section(const SectionEntry& entry) {
    std::array<std::byte, section_entry_bytes> bytes;
    std::ranges::copy(std::as_bytes(std::span(entry.type)), bytes.begin());
    store_le(bytes.data() + 4, entry.crc);
    store_le(bytes.data() + 8, entry.length);
    return bytes;
}

bool is_section_type(const std::string& type) {
    const auto letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
    return type.size() == 4 && std::ranges::all_of(type, letter);
}

bool is_known_section(const std::string& type) {
    constexpr const char* known[] = {"CODE", "LEVL", "ROOT", "LAYR", "meta", "geom", "prxy"};
    return std::ranges::find(known, type) != std::end(known) || follows_head(type);
}

bool follows_head(const std::string& type) {
    return type == "INDX" || type == "DATA";
}

} // namespace tessera
