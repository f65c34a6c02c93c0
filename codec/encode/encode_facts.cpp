#include "codec/encode/encode_facts.h"

#include "codec/decoder.h"
#include "format/container/syntax.h"
#include "format/io/crc32c.h"
#include "format/metadata.h"

#include <charconv>
#include <cstdio>

namespace tessera {
namespace {

constexpr std::size_t longest_value = 100;

std::string checksum_text(std::uint32_t crc) {
    char text[16];
    std::snprintf(text, sizeof text, "%08x", crc);
    return text;
}

std::string checksum_of(std::span<const std::byte> bytes) {
    return std::to_string(bytes.size()) + " bytes of checksum " + checksum_text(crc32c(bytes));
}

std::string shortened(const std::string& value) {
    return value.size() <= longest_value ? value : checksum_of(std::as_bytes(std::span(value)));
}

// The fewest digits from which the same number is read again.
std::string exact(double value) {
    char text[400]; // of any double without an exponent
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed).ptr;
    return {text, end};
}

// "psnr 40".
std::string rate_text(const RateTarget& rate) {
    using Kind = RateTarget::Kind;
    const char* kind = rate.kind == Kind::quality ? "quality "
                       : rate.kind == Kind::psnr  ? "psnr "
                       : rate.kind == Kind::bpt   ? "bpt "
                       : rate.kind == Kind::bytes ? "bytes "
                                                  : "max-error ";
    return kind + exact(rate.value);
}

// "-copies,+grids".
std::string tools_text(const ToolSwitches& tools) {
    std::string text;
    for (std::size_t i = 0; i < coding_tool_names.size(); ++i) {
        const auto tool = static_cast<CodingTool>(i);
        const bool on = tools.is_on(tool, false), off = !tools.is_on(tool, true);
        if (on || off)
            text += std::string(text.empty() ? "" : ",") + (on ? "+" : "-") + coding_tool_names[i];
    }
    return text;
}

std::string description_text(const Description& d) {
    std::string text = std::string(name_of(d.proxy)) + " " + name_of(d.surface_map) + " " +
                       name_of(d.angular_map) + " " + name_of(d.transfer) + " " +
                       name_of(d.primaries) + " " + name_of(d.alpha);
    for (const float number : {d.sphere_centre[0], d.sphere_centre[1], d.sphere_centre[2],
                               d.sphere_radius, d.viewing_radius[0], d.viewing_radius[1]})
        text += " " + exact(static_cast<double>(number));
    return text;
}

} // namespace

JournalFacts facts_of(const EncodePlan& plan) {
    const EncodeOptions& o = plan.options;
    const TextureDesc& desc = plan.colour.desc;
    JournalFacts facts = {
        {"version of the encoder", library_version},
        {"size", to_string(plan.views.texture_size())},
        {"sample type", traits_of(desc.type).name},
        {"number of channels", std::to_string(desc.channels)},
        {"rate", rate_text(o.rate)},
        {"effort", std::to_string(o.effort)},
        {"layers", o.layers ? "coarse levels" : "none"},
        {"strictness", o.strict ? "strict" : "lenient"},
        {"description", description_text(o.description)},
    };
    if (!o.mesh.empty())
        facts.emplace_back("mesh", checksum_of(o.mesh));
    if (o.reuse != nullptr) {
        const ContainerReader& reused = o.reuse->container();
        facts.emplace_back("file to reuse", std::to_string(reused.file_bytes()) +
                                                " bytes with the identity " +
                                                std::to_string(reused.header().identity));
    }
    if (o.mask != nullptr)
        facts.emplace_back("size of the mask", to_string(o.mask->desc().size));
    for (const auto& [name, value] : o.labels.facts)
        facts.emplace_back(name, shortened(value));
    for (const auto& [key, value] : o.metadata)
        facts.emplace_back("metadata " + key, shortened(value));
    return facts;
}

JournalFacts facts_of(const EncodePlan& plan, const Sample& sample) {
    JournalFacts facts = facts_of(plan);
    if (const ViewAlignment alignment = plan.views.alignment(); alignment.any())
        facts.emplace_back("alignment of views",
                           std::to_string(alignment.u) + ", " + std::to_string(alignment.v));
    facts.emplace_back("largest tile", to_string(plan.grid.tile_extent()));
    std::uint32_t crc = 0;
    for (const TileTexels& tile : sample.tiles)
        crc = crc32c(tile.matters, crc32c(tile.texels, crc));
    facts.emplace_back("checksum of sampled texels", checksum_text(crc));
    return facts;
}

Metadata given_metadata(const EncodePlan& plan) {
    Metadata metadata = plan.options.metadata;
    std::erase_if(metadata, [](const auto& entry) { return entry.first.starts_with(made_prefix); });
    return metadata;
}

Metadata recorded_metadata(const EncodePlan& plan) {
    const EncodeOptions& options = plan.options;
    Metadata metadata = given_metadata(plan);
    const std::string software = std::string("Tessera ") + library_version;
    if (options.reuse != nullptr) { // its tiles decide the quantiser
        const Metadata& reused = options.reuse->container().metadata();
        if (reused.contains(software_key)) // otherwise it is a small file, and so will be this one
            metadata.try_emplace(software_key, software);
        for (const auto& entry : reused)
            if (entry.first.starts_with(made_prefix))
                metadata.insert(entry);
        return metadata;
    }
    metadata.try_emplace(software_key, software);
    metadata[made_rate_key] = rate_text(options.rate);
    metadata[made_effort_key] = std::to_string(options.effort);
    if (std::string tools = tools_text(plan.tools); !tools.empty())
        metadata[made_tools_key] = std::move(tools);
    return metadata;
}

} // namespace tessera
