// tessera.json: what `decode` knew about a folder of views when it wrote them.
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

// No value if the folder has no such file. Errors: io (also if it is not a regular file),
// invalid_file.
Result<std::optional<ViewsJson>> read_views_json(const std::string& folder);

std::string to_text(const TextureDesc& desc, const Description& description,
                    const ViewLayout& layout);

} // namespace tessera
