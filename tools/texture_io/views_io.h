// A texture as a folder of pictures, one per view, x = u and y = v: PNG, JPEG or EXR with any names
// that view_names.h understands. Folders that we wrote also hold tessera.json (views_json.h).
#pragma once

#include "format/metadata.h"
#include "format/texture.h"
#include "tools/support/texture_hints.h"
#include "tools/texture_io/view_layout.h"

#include <memory>
#include <string>

namespace tessera {

// What was detected in pictures of views.
struct ViewsFacts {
    Description description;
    bool described = false; // by a tessera.json
    ViewLayout layout;
    std::string told; // the interpretation in words, for people; "" where it is obvious
};

// The size comes from tessera.json or, without one, from the names and the first picture; a hint
// must agree. Where neither names nor hints say whether the first number counts rows or columns, the
// motion of the views decides, if it is clear. All views must be present and have the same size and channels. Reads the views of one
// slab at a time, from regular files only. Errors: io; invalid_file (a view is missing, damaged or
// differs), bad_argument (ambiguous names), unsupported; runtime, when interrupted.
Result<std::unique_ptr<TexelSource>> open_views(const std::string& folder,
                                                const TextureHints& hints, ViewsFacts& facts);

// Whether create_views() can write such views. Errors: bad_argument (the pattern names several
// views alike), unsupported (half floats as PNG or JPEG, alpha as JPEG).
Status check_views_output(const TextureDesc& desc, const ViewLayout& layout);

// Writes to "<folder>.<pid>.tmp", which finish() renames. Replaces an existing folder only if it is
// empty or contains nothing but views and a tessera.json. layout.pattern gives the names and, by
// its ending, the kind of picture. Errors: io, and those of check_views_output().
Result<std::unique_ptr<TexelSink>> create_views(const std::string& folder, const TextureDesc& desc,
                                                const Description& description,
                                                const ViewLayout& layout, unsigned threads);

} // namespace tessera
