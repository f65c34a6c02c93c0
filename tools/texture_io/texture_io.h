// Textures by name: what kind a name means, and how to open or create the texture. The content of
// an input, where it has a signature, wins over its name.
//
//   x.tess      compressed; open_texture() reads it, encode writes it. Also the URL of one,
//               http(s)://host/x.tess, with any ?query or #fragment
//   x.glb       glTF with a .tess inside, which is read like the .tess
//   x.exr       mosaic, see exr_writer.h
//   x.rgb       raw, see raw_io.h; also .rgba .gray .ya, with 16f appended for half floats
//               (.rgb16f), and .raw, for which hints must give type and channels
//   folder/     one picture per view, see views_io.h; a trailing slash or an existing folder
//   x.png .jpg  a mosaic, a quilt or a view, see picture_io.h
//   -           standard input: any kind that is one file (raw needs size, type and channels);
//               standard output: raw texels
#pragma once

#include "codec/decoder.h"
#include "format/metadata.h"
#include "format/texture.h"
#include "tools/support/output_folders.h" // for callers, which write files, too
#include "tools/support/texture_hints.h"
#include "tools/texture_io/view_layout.h"

#include <memory>
#include <string>
#include <utility>

namespace tessera {

enum class TextureKind { tess, exr, raw, views, picture, unknown };
// The kind of an output, from its name alone.
TextureKind kind_of(const std::string& path);
// The kind of an input, from its first bytes, else from its name.
TextureKind kind_of_input(const std::string& path);

// Opens a .tess for a verb that reads nothing else. Errors: those of open_bytes(); bad_argument for
// another kind, by its content or name.
Result<std::unique_ptr<ByteSource>> open_tess_bytes(const std::string& path, const char* verb);

struct OpenedTexture {
    TextureKind kind = TextureKind::unknown;
    std::unique_ptr<TexelSource> source;
    const Decoder* decoder = nullptr; // of a .tess; lives as long as the source
    Metadata metadata;                // of a .tess; of views, the keys Views and Cameras
    Description description;          // as far as the file has one
    std::string told;                 // how pictures of views were interpreted, for people; else ""
    bool planar = false; // whether there are many views and no description: those of a planar grid
};

// Errors: bad_argument (a name of no known kind, missing hints), io, invalid_file, unsupported.
Result<OpenedTexture> open_texture(const std::string& path, const TextureHints& hints);

// Opens two textures that are to be compared: without hints.size, a raw one has the size of the
// other. Errors: those of open_texture().
Result<std::pair<OpenedTexture, OpenedTexture>>
open_two_textures(const std::string& first, const std::string& second, TextureHints hints);

// Whether create_texture() would accept this name. Writes nothing. `layout`: of folders of views
// and of pictures. Errors: bad_argument (a name of no known kind, or one that contradicts `desc`),
// io, unsupported.
Status check_texture_output(const std::string& path, const TextureDesc& desc,
                            const ViewLayout& layout = {});

// A sink for `desc` that becomes `path` when finished. Creates missing folders. Errors: those of
// check_texture_output(), unsupported.
Result<std::unique_ptr<TexelSink>> create_texture(const std::string& path, const TextureDesc& desc,
                                                  const Description& description, unsigned threads,
                                                  const ViewLayout& layout = {});

// with_partial_hint() of fill_text.h for the texture of this name, if it is a .tess.
Status with_partial_hint(const Status& status, const std::string& name,
                         const DecodeOptions& options);
// The same for the first of two that is cut short.
Status with_partial_hint(const Status& status, const std::string& first, const std::string& second,
                         const DecodeOptions& options);

} // namespace tessera
