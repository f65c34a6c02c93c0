// What tells a texture's file from another one, or from itself after a change, without reading it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tessera {

// For EncodeOptions::source_facts: length and time of last change of the file at `path`; for a
// folder of views their number and a checksum of their names, lengths and times. The path itself is
// not among them. What cannot be read is left out: opening it will say why. `what`: "input", or what
// else the file is, for the facts' names.
std::vector<std::pair<std::string, std::string>> source_facts(const std::string& path,
                                                              const std::string& what);

} // namespace tessera
