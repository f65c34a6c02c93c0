// File names that are URLs.
#pragma once

#include <string>

namespace tessera {

// The text before "://", in lower case; "" for a path.
std::string scheme_of(const std::string& name);

// Whether the name begins with a scheme and "://". Such a name is not a path.
bool is_url(const std::string& name);

// The name without the ?query and #fragment of a URL, so that its extension comes last.
std::string without_query(const std::string& name);

} // namespace tessera
