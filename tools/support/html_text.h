// Text inside HTML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// Escapes `text` for use as text or in a quoted attribute. Control characters become spaces.
std::string html_text(std::string_view text);

} // namespace tessera
