// tessera.json beside the views of a folder: what `decode` knew when it wrote them.
#pragma once

#include "format/metadata.h"
#include "format/texture.h"
#include "tools/texture_io/view_layout.h"

#include <optional>
#include <string>

namespace tessera {

inline constexpr const char* views_json_name = "tessera.json";

struct ViewsJson {
    Extent4 size{0, 0, 0, 0};
    Description description;
    ViewLayout layout;
};

// Nothing where there is no such file. Errors: io (also what is no regular file), invalid_file.
Result<std::optional<ViewsJson>> read_views_json(const std::string& folder);

std::string to_text(const TextureDesc& desc, const Description& description,
                    const ViewLayout& layout);

} // namespace tessera
