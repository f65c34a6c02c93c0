// Names that are URLs.
#pragma once

#include <string>

namespace tessera {

// What stands before "://", in lower case; "" for a path.
std::string scheme_of(const std::string& name);

// Whether the name begins with a scheme and "://". Such a name is never a path.
bool is_url(const std::string& name);

// The name without a URL's ?query and #fragment: what its ending says counts.
std::string without_query(const std::string& name);

} // namespace tessera
