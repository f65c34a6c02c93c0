// A texture as a folder of PNG pictures, one per view: view_tTTT_sSSS.png is U x V pixels, with
// x = u and y = v. Beside them tessera.json says size, type, channels and what the description
// knows. 8-bit textures only.
#pragma once

#include "format/metadata.h"
#include "format/texture.h"
#include "tools/support/texture_hints.h"

#include <memory>
#include <string>

namespace tessera {

// The size comes from tessera.json or, without one, from the names and the first picture; a hint
// must agree. All views must be there and alike. Reads the views of one slab at a time.
// Errors: io, invalid_file (a view missing, of another shape or damaged), unsupported (16 bits).
Result<std::unique_ptr<TexelSource>>
open_png_views(const std::string& folder, const TextureHints& hints, Description& description);

// Written to "<folder>.<pid>.tmp" and renamed by finish(). An existing folder is replaced only if
// it is empty or holds nothing but views and a tessera.json. Errors: io, unsupported (half).
Result<std::unique_ptr<TexelSink>> create_png_views(const std::string& folder,
                                                    const TextureDesc& desc,
                                                    const Description& description,
                                                    unsigned threads);

// "view_t003_s012.png"
std::string view_file_name(std::uint32_t s, std::uint32_t t);
// Whether `name` is such a name (any number of digits up to 7), and of which view.
bool parse_view_file_name(const std::string& name, std::uint32_t& s, std::uint32_t& t);

} // namespace tessera
