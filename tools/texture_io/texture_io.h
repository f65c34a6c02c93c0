// Textures by name: what kind of file a name means, and how to open or create it. An input is what its
// first bytes say, if they say something, whatever its name.
//
//   x.tess      compressed                       (reading only; encode writes it); also the URL of
//               one, http(s)://host/x.tess, whatever ?query or #fragment follows
//   x.exr       mosaic, see exr_io.h
//   x.rgb       raw, see raw_io.h; also .rgba .gray .ya, with 16f appended for half floats
//               (.rgb16f), and .raw, for which type and channels must be said
//   folder/     one picture per view, see views_io.h; a trailing slash or an existing folder
//   x.png .jpg  a mosaic, a quilt or a view, see picture_io.h
//   -           standard input: any kind that is one file (raw needs size, type and channels);
//               standard output: raw texels
#pragma once

#include "codec/decoder.h"
#include "format/metadata.h"
#include "format/texture.h"
#include "tools/support/output_folders.h" // its users write files, too
#include "tools/support/texture_hints.h"
#include "tools/texture_io/view_layout.h"

#include <memory>
#include <string>
#include <utility>

namespace tessera {

enum class TextureKind { tess, exr, raw, views, picture, unknown };
// By the name alone: of an output.
TextureKind kind_of(const std::string& path);
// Of an input: by its first bytes, else by its name.
TextureKind kind_of_input(const std::string& path);

// A .tess for a verb that reads nothing else. Errors: those of open_bytes(); bad_argument where it is
// another kind, by its content or name.
Result<std::unique_ptr<ByteSource>> open_tess_bytes(const std::string& path, const char* verb);

struct OpenedTexture {
    TextureKind kind = TextureKind::unknown;
    std::unique_ptr<TexelSource> source;
    const Decoder* decoder = nullptr; // of a .tess; lives as long as the source
    Metadata metadata;                // of a .tess; of views, the key Views
    Description description;          // as far as the file knows
    // What pictures of views were taken for, for people; "" for other kinds.
    std::string told;
    // Whether they are cameras of a planar grid: many views, and nothing says otherwise.
    bool planar = false;
};

// Errors: bad_argument (name of no known kind, hints missing), io, invalid_file, unsupported.
Result<OpenedTexture> open_texture(const std::string& path, const TextureHints& hints);

// The same for two that are set beside each other: a raw one takes its size from the other where the
// hints have none. Errors: those of both.
Result<std::pair<OpenedTexture, OpenedTexture>>
open_two_textures(const std::string& first, const std::string& second, TextureHints hints);

// Whether create_texture() would take this name. Writes nothing. Errors: bad_argument (name of no known
// kind, or one that contradicts `desc`), io, unsupported. `layout`: of folders of views, and pictures.
Status check_texture_output(const std::string& path, const TextureDesc& desc,
                            const ViewLayout& layout = {});

// A sink for `desc` that becomes `path` when finished; missing folders are made. Errors: those of
// check_texture_output(), unsupported.
Result<std::unique_ptr<TexelSink>> create_texture(const std::string& path, const TextureDesc& desc,
                                                  const Description& description, unsigned threads,
                                                  const ViewLayout& layout = {});

// fill_text.h: with_partial_hint(), of the texture of this name if it is a .tess.
Status with_partial_hint(const Status& status, const std::string& name,
                         const DecodeOptions& options);
// The same of two, of which the first that is cut counts.
Status with_partial_hint(const Status& status, const std::string& first, const std::string& second,
                         const DecodeOptions& options);

} // namespace tessera
