// Textures by name: what kind of file a name means, and how to open or create it.
//
//   x.tess      compressed                       (reading only; encode writes it); also the URL of
//               one, http(s)://host/x.tess, whatever ?query or #fragment follows
//   x.exr       mosaic, see exr_io.h
//   x.rgb       raw, see raw_io.h; also .rgba .gray .ya, with 16f appended for half floats
//               (.rgb16f), and .raw, for which type and channels must be said
//   folder/     one PNG per view, see png_views_io.h; a trailing slash or an existing folder
#pragma once

#include "codec/decoder.h"
#include "format/metadata.h"
#include "format/texture.h"
#include "tools/support/texture_hints.h"

#include <memory>
#include <string>
#include <utility>

namespace tessera {

enum class TextureKind { tess, exr, raw, png_views, unknown };
TextureKind kind_of(const std::string& path);

struct OpenedTexture {
    TextureKind kind = TextureKind::unknown;
    std::unique_ptr<TexelSource> source;
    const Decoder* decoder = nullptr; // of a .tess; lives as long as the source
    Metadata metadata;       // of a .tess
    Description description; // as far as the file knows
};

// Errors: bad_argument (name of no known kind, hints missing), io, invalid_file, unsupported.
Result<OpenedTexture> open_texture(const std::string& path, const TextureHints& hints);

// The same for two that are set beside each other: a raw one takes its size from the other where the
// hints have none. Errors: those of both.
Result<std::pair<OpenedTexture, OpenedTexture>>
open_two_textures(const std::string& first, const std::string& second, TextureHints hints);

// A sink for `desc` that becomes `path` when finished. Errors: bad_argument (name of no known kind,
// or one that contradicts `desc`), io, unsupported.
Result<std::unique_ptr<TexelSink>> create_texture(const std::string& path, const TextureDesc& desc,
                                                  const Description& description, unsigned threads);

// Whether a file may be written there: a plain file or nothing, in a folder that exists. Renaming over
// a device or a folder would destroy it or fail after all the work. Errors: io; bad_argument (a URL).
Status check_output_path(const std::string& path);

} // namespace tessera
