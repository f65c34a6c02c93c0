// Identifies the state of a file or folder without reading it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tessera {

// For EncodeLabels::facts: length and modification time of the file at `path`; for a
// folder, the number of its files and a checksum of their names, lengths and times. The path is not
// included. Files that cannot be read are left out, since opening them reports why. `what` is part
// of the facts' names, such as "input".
std::vector<std::pair<std::string, std::string>> source_facts(const std::string& path,
                                                              const std::string& what);

} // namespace tessera
