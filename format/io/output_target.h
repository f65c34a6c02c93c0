// What a new file replaces, and what it keeps of it.
#pragma once

#include "format/status.h"

#include <string>

namespace tessera {

// The mode and owner of the file or folder at `target` for an open file or folder that will replace
// it; the owner only where the system allows it. Does nothing if there is no `target`.
void keep_mode_and_owner(int descriptor, const std::string& target);

} // namespace tessera
