// How the views of a texture are laid out in pictures, as a text that files keep (key Views,
// tessera.json), so that `decode` can write pictures like those that were encoded.
#pragma once

#include "format/metadata.h"
#include "tools/support/texture_hints.h"

#include <optional>
#include <string>

namespace tessera {

// The metadata key (FORMAT.md 5.5).
inline constexpr const char* views_key = "Views";

struct ViewLayout {
    std::string pattern{};           // of the names in a folder; empty: usual_view_pattern
    std::optional<ViewGrid> quilt{}; // columns and rows in a single picture; none: a mosaic
    ViewOrder order{};               // of the views in a folder or quilt
    std::string cameras{}; // their positions (camera_grid.h); empty: unknown. Not in the text
};

// "order:serpentine names:cam{n:3}.png", "quilt:8x6 order:bottom-up"; "" for the default.
std::string to_string(const ViewLayout& layout);
// Parts of the text that are unknown or invalid keep their defaults.
ViewLayout parse_view_layout(const std::string& text);

// The layout that the user asks for, else that in the metadata of a file. A pattern, quilt or
// mosaic from the user replaces the whole layout, an order only the order.
ViewLayout layout_for(const ViewHints& asked, const Metadata& metadata);

// The columns and rows in the name of a Looking Glass quilt, "any_qs8x6a0.75.png".
std::optional<ViewGrid> quilt_in_name(const std::string& path);

// The camera at a quilt's column and row (from the top). Views follow `order` through the quilt and
// go line by line through the grid of cameras, which is `cameras` wide.
ViewPlace camera_in_quilt(const ViewGrid& quilt, const ViewOrder& order, std::uint32_t cameras,
                          const ViewPlace& cell);

} // namespace tessera
