// The description of a texture as text, one word or list per field: options of the command line,
// attributes of an EXR mosaic, entries of tessera.json.
#pragma once

#include "format/metadata.h"
#include "format/status.h"

#include <map>
#include <string>
#include <string_view>

namespace tessera {

inline constexpr const char* description_fields[] = {
    "proxy", "surface-map", "angular-map", "transfer", "primaries", "alpha", "viewing-radius"};

// What a field accepts, for help texts.
std::string description_field_values(std::string_view field);

// Sets one field. The values are those that description_to_text() writes. Errors: bad_argument,
// with the values that are allowed. `proxy` does not accept "mesh", since a mesh is more than a
// word.
Status set_description_field(Description& description, std::string_view field,
                             const std::string& text);

// The fields whose values differ from the default. A mesh as the proxy is left out.
std::map<std::string, std::string> description_to_text(const Description& description);

} // namespace tessera
