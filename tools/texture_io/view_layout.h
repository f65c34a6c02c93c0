// How the views of a texture lie in pictures, as a text that files keep (key Views, tessera.json), so
// that `decode` can write pictures of the kind that they came from.
#pragma once

#include "format/metadata.h"
#include "tools/support/texture_hints.h"

#include <optional>
#include <string>

namespace tessera {

// The key that holds it (FORMAT.md 5.5).
inline constexpr const char* views_key = "Views";

struct ViewLayout {
    std::string pattern;           // of a folder's names; empty: view_tTTT_sSSS.png
    std::optional<ViewGrid> quilt; // of a single picture; none: it is a mosaic
    ViewOrder order;               // of either
    std::string cameras; // where they stand (camera_grid.h), beside the text; empty: not known
};

// "names:cam{n:3}.png order:serpentine", "quilt:8x6 order:bottom-up"; "" for the usual.
std::string to_string(const ViewLayout& layout);
// The usual layout where the text says none that we know.
ViewLayout parse_view_layout(const std::string& text);

// What was asked for, else what the file says, as far as that goes together.
ViewLayout layout_for(const ViewHints& asked, const Metadata& metadata);

// The columns and rows that a quilt's name says, as Looking Glass has it: "any_qs8x6a0.75.png".
std::optional<ViewGrid> quilt_in_name(const std::string& path);

// Which camera is at a quilt's column and row (from the top), by its order; cameras go line by line
// through a grid that is `cameras` wide.
ViewPlace camera_in_quilt(const ViewGrid& quilt, const ViewOrder& order, std::uint32_t cameras,
                          const ViewPlace& cell);

} // namespace tessera
