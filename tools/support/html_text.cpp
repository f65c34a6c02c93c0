#include "tools/support/html_text.h"

namespace tessera {

std::string html_text(std::string_view text) {
    std::string safe;
    for (const char c : text)
        safe += c == '&'                             ? "&amp;"
                : c == '<'                           ? "&lt;"
                : c == '>'                           ? "&gt;"
                : c == '"'                           ? "&quot;"
                : static_cast<unsigned char>(c) < 32 ? " "
                                                     : std::string(1, c);
    return safe;
}

} // namespace tessera
