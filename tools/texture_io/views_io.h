// A texture as a folder of pictures, one per view, x = u and y = v: PNG, JPEG or EXR, by any names that
// view_names.h understands. Beside those that we wrote tessera.json says what the description knows.
#pragma once

#include "format/metadata.h"
#include "format/texture.h"
#include "tools/support/texture_hints.h"
#include "tools/texture_io/view_layout.h"

#include <memory>
#include <string>

namespace tessera {

// What was understood of pictures of views.
struct ViewsFacts {
    Description description;
    bool described = false; // by a tessera.json
    ViewLayout layout;
    std::string told; // what it was taken for, for people
};

// The size comes from tessera.json or, without one, from the names and the first picture; a hint
// must agree. All views must be there and alike. Reads the views of one slab at a time, from regular
// files only. Errors: io; invalid_file (a view missing, of another shape or damaged), bad_argument
// (names that could mean several things), unsupported; runtime, when interrupted.
Result<std::unique_ptr<TexelSource>> open_views(const std::string& folder,
                                                const TextureHints& hints, ViewsFacts& facts);

// Whether the views can be written so. Errors: unsupported (half floats as PNG or JPEG, alpha as JPEG).
Status check_views_output(const TextureDesc& desc, const ViewLayout& layout);

// Written to "<folder>.<pid>.tmp" and renamed by finish(). An existing folder is replaced only if
// it is empty or holds nothing but views and a tessera.json. Names are layout.pattern's, the kind of
// picture is that of its ending. Errors: io, and those of check_views_output().
Result<std::unique_ptr<TexelSink>> create_views(const std::string& folder, const TextureDesc& desc,
                                                const Description& description,
                                                const ViewLayout& layout, unsigned threads);

} // namespace tessera
