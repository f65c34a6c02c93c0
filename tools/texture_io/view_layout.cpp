#include "tools/texture_io/view_layout.h"

#include "format/output_file.h"
#include "tools/support/camera_grid.h"
#include "tools/texture_io/view_pattern.h"

#include <filesystem>
#include <sstream>

namespace tessera {

std::string to_string(const ViewLayout& layout) {
    std::string text;
    if (layout.quilt)
        text = "quilt:" + to_string(*layout.quilt);
    if (const std::string order = to_string(layout.order); !order.empty())
        text += (text.empty() ? "order:" : " order:") + order;
    if (!layout.pattern.empty() && layout.pattern != usual_view_pattern)
        text += (text.empty() ? "names:" : " names:") +
                layout.pattern; // last, as it may contain spaces
    return text;
}

ViewLayout parse_view_layout(const std::string& text) {
    ViewLayout layout;
    std::string words = text;
    if (const std::size_t at = words.find("names:"); at != std::string::npos) {
        if (ViewPattern::parse(words.substr(at + 6)).ok())
            layout.pattern = words.substr(at + 6);
        words.resize(at);
    }
    std::istringstream in(words);
    for (std::string word; in >> word;) {
        const std::size_t colon = word.find(':');
        const std::string value = colon == std::string::npos ? "" : word.substr(colon + 1);
        if (word.starts_with("quilt:")) {
            if (const auto grid = parse_view_grid(value); grid.ok())
                layout.quilt = *grid;
        } else if (word.starts_with("order:")) {
            if (const auto order = parse_view_order(value); order.ok())
                layout.order = *order;
        }
    }
    return layout;
}

ViewLayout layout_for(const ViewHints& asked, const Metadata& metadata) {
    const auto kept = metadata.find(views_key);
    ViewLayout layout = kept == metadata.end() ? ViewLayout{} : parse_view_layout(kept->second);
    if (!asked.pattern.empty() || asked.quilt || asked.mosaic)
        layout = {.pattern = asked.pattern, .quilt = asked.quilt};
    if (asked.quilt && !asked.grid)
        layout.order.bottom_up = true;
    if (asked.order)
        layout.order = *asked.order;
    if (const auto cameras = metadata.find(cameras_key); cameras != metadata.end())
        layout.cameras = cameras->second;
    return layout;
}

std::optional<ViewGrid> quilt_in_name(const std::string& path) {
    const std::string name = to_path(path).filename().string();
    const std::size_t at = name.rfind("_qs");
    if (at == std::string::npos)
        return std::nullopt;
    const std::size_t end = name.find_first_not_of("0123456789x", at + 3);
    if (end == std::string::npos || (name[end] != 'a' && name[end] != '.'))
        return std::nullopt;
    const auto grid = parse_view_grid(name.substr(at + 3, end - at - 3));
    return grid.ok() ? std::optional(*grid) : std::nullopt;
}

ViewPlace camera_in_quilt(const ViewGrid& quilt, const ViewOrder& order, std::uint32_t cameras,
                          const ViewPlace& cell) {
    const ViewStep at = step_of(quilt, order, cell);
    const std::uint32_t number = at.line * line_length(quilt, order) + at.step;
    return {number % cameras, number / cameras};
}

} // namespace tessera
