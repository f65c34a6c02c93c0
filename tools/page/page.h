// The HTML page that shows a texture in a browser. It contains the viewer and the decoder, and on
// request the texture.
#pragma once

#include "format/byte_source.h"
#include "format/status.h"
#include "tools/server/file_server.h"

#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// The contents of a page with its own texture, besides the viewer.
struct PageContents {
    std::string title;
    glm::dvec3 background{0.1};       // colour around the picture, as displayed, 0..1
    std::vector<std::byte> poster;    // a PNG to show while the page opens; may be empty
    std::vector<std::byte> view_data; // make_view_data()
    ByteSource* file = nullptr;       // the .tess
};

// Receives the next piece of a page.
using PageSink = std::function<Status(std::string_view piece)>;

// Passes the HTML to `append` in pieces, and reads the file in pieces. Errors: unsupported, if this
// build has no decoder for browsers (the message says what to install), before any piece; runtime;
// those of the file and of `append`.
Status write_page(const PageContents& contents, const PageSink& append);
// The page for a server. It shows the file NAME.tess beside it if its URL ends in ?f=NAME.tess.
// Errors: as above.
Result<std::string> make_server_page();

// A file that the server page fetches where the browser has WebGPU. `name`: such as "gpu_worker.js"
// or "wgsl/half/texels.comp.wgsl". Nothing if there is no such file.
std::optional<ViewerPart> viewer_part(std::string_view name);

} // namespace tessera
