// The description of a texture as words, one per field: the options of the command line, the
// attributes of an EXR mosaic and the entries of tessera.json.
#pragma once

#include "format/metadata.h"
#include "format/status.h"

#include <map>
#include <string>
#include <string_view>

namespace tessera {

// Fields: proxy ("sphere:cx,cy,cz,r", "sphere-inside:cx,cy,cz,r"; a mesh is not said), surface-map, angular-map, transfer, primaries, alpha,
// viewing-radius ("near,far").
inline constexpr const char* description_fields[] = {
    "proxy", "surface-map", "angular-map", "transfer", "primaries", "alpha", "viewing-radius"};

// What may be said, for help texts.
std::string description_field_values(std::string_view field);

// Errors: bad_argument, which lists what is allowed.
Status set_description_field(Description& description, std::string_view field,
                             const std::string& text);

// Only the fields that say something.
std::map<std::string, std::string> description_to_text(const Description& description);

} // namespace tessera
