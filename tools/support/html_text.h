// Text inside HTML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// As text or as a quoted attribute; control characters become blanks.
std::string html_text(std::string_view text);

} // namespace tessera
