// OpenGL's error flag as a Status.
#pragma once

#include "format/status.h"

#include <string>

namespace tessera {

// Clears the error flags of the current context. Returns ok if there were none, else runtime with
// the message "what: " and their names. Meant for the end of a batch of calls, which report nothing
// themselves.
Status take_gl_errors(const std::string& what);

} // namespace tessera
