#include "tools/texture_io/views_json.h"

#include "format/byte_source.h"
#include "format/output_file.h"
#include "tools/support/description_text.h"
#include "tools/support/parse.h"

#include <filesystem>
#include <nlohmann/json.hpp>

namespace tessera {
namespace {

constexpr std::uint64_t max_json_bytes = 1 << 20;

Status fill_description(const nlohmann::json& fields, Description& description) {
    for (const auto& [field, value] : fields.items())
        if (Status s = value.is_string()
                           ? set_description_field(description, field, value.get<std::string>())
                           : Status(ErrorCode::invalid_file, field + " is not text");
            !s.ok())
            return {ErrorCode::invalid_file, s.message()};
    return {};
}

} // namespace

Result<std::optional<ViewsJson>> read_views_json(const std::string& folder) {
    const std::string path = folder + "/" + views_json_name;
    std::error_code error;
    if (!std::filesystem::exists(to_path(path), error))
        return std::optional<ViewsJson>();
    TESSERA_TRY_ASSIGN(const auto file, open_file(path));
    if (file->size() > max_json_bytes)
        return Status(ErrorCode::invalid_file, path + ": too long");
    std::string text(file->size(), '\0');
    TESSERA_TRY(file->read(0, std::as_writable_bytes(std::span(text))));
    const auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("size") || !json["size"].is_string())
        return Status(ErrorCode::invalid_file, path + ": is not JSON with a \"size\": \"UxVxSxT\"");
    ViewsJson found;
    const auto size = parse_extent(json["size"].get<std::string>());
    if (!size.ok())
        return Status(ErrorCode::invalid_file, path + ": " + size.status().message());
    found.size = *size;
    if (json.contains("views") && json["views"].is_string())
        found.layout = parse_view_layout(json["views"].get<std::string>());
    if (json.contains("cameras") && json["cameras"].is_string())
        found.layout.cameras = json["cameras"].get<std::string>();
    if (json.contains("description") && json["description"].is_object())
        TESSERA_TRY(fill_description(json["description"], found.description).with_context(path));
    return std::optional(std::move(found));
}

std::string to_text(const TextureDesc& desc, const Description& description,
                    const ViewLayout& layout) {
    nlohmann::json json = {{"format", "tessera views"},
                           {"size", to_string(desc.size)},
                           {"type", name_of(desc.type)},
                           {"channels", desc.channels},
                           {"description", description_to_text(description)}};
    if (const std::string text = to_string(layout); !text.empty())
        json["views"] = text;
    if (!layout.cameras.empty())
        json["cameras"] = layout.cameras;
    return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

} // namespace tessera
