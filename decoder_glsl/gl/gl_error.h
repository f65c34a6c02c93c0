// OpenGL's error flag as a Status.
#pragma once

#include "format/status.h"

#include <string>

namespace tessera {

// Takes the errors that earlier OpenGL calls left on the current context: ok, or runtime with their
// names behind "what: ". Useful after a frame or a batch of calls that report nothing themselves.
Status take_gl_errors(const std::string& what);

} // namespace tessera
