// The page that shows a texture in a browser: viewer and decoder, and where it stands alone the texture, too.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// What a page that stands alone holds besides the viewer.
struct PageContents {
    std::string title;
    glm::dvec3 background{0.1};       // around the picture, as displayed, 0..1
    std::vector<std::byte> poster;    // a PNG that is shown while the page opens; may be empty
    std::vector<std::byte> view_data; // make_view_data()
    std::span<const std::byte> file;  // the .tess
};

// HTML. Errors: unsupported, where this program was built without the decoder for browsers, and says what to
// install; runtime.
Result<std::string> make_page(const PageContents& contents);
// The same without contents, for a server: shows the file of its folder that ?f=NAME.tess names.
Result<std::string> make_server_page();

} // namespace tessera
