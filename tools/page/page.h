// The page that shows a texture in a browser: viewer and decoder, and where it stands alone the texture, too.
#pragma once

#include "format/byte_source.h"
#include "format/status.h"

#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// What a page that stands alone holds besides the viewer.
struct PageContents {
    std::string title;
    glm::dvec3 background{0.1};       // around the picture, as displayed, 0..1
    std::vector<std::byte> poster;    // a PNG that is shown while the page opens; may be empty
    std::vector<std::byte> view_data; // make_view_data()
    ByteSource* file = nullptr;       // the .tess
};

// Takes the next piece of a page.
using PageSink = std::function<Status(std::string_view piece)>;

// HTML, from the first byte to the last; the file is read, and passed on, in pieces. Errors: unsupported, where
// this program was built without the decoder for browsers, and says what to install, before anything is
// passed on; runtime; those of the file and of `append`.
Status write_page(const PageContents& contents, const PageSink& append);
// The same without contents, for a server: shows the file of its folder that ?f=NAME.tess names.
Result<std::string> make_server_page();

} // namespace tessera
