// What `tessera render` draws: a compressed file or a scene's texture, and what is set beside it.
#pragma once

#include "codec/decoder.h"
#include "tools/support/traffic.h"
#include "tools/view/planar_renderer.h"
#include "tools/view/view_renderer.h"

#include <memory>
#include <optional>
#include <string>

namespace tessera {

struct StageRequest {
    std::string file;         // a .tess; or empty, and then:
    std::string scene;        // the texture of a built-in scene, baked where it is looked at,
    std::string texture_size; // of "UxVxSxT" texels; empty: the scene's own
    DecodeOptions decode;     // of the file
    std::string via = "cpu";  // cpu, gpu, load or feedback
    unsigned budget_mib = 512;
    std::optional<unsigned> rays;  // per pixel, on the CPU; else 1 for a sphere and 4 for a mesh
    std::optional<double> focus;   // of planar views: distance from their cameras
    unsigned tiles_per_frame = 0;  // with feedback, see gpu_renderer.h
    std::string truth;             // a scene, or a model's file, to ray trace directly; or empty
    std::string truth_environment; // of a model: where its light is now; empty: where it was
    std::optional<unsigned>
        truth_samples;               // per pixel; else 16 rays of a scene, 512 paths of a model
    std::string original;            // the uncompressed texture as a file, or empty
    std::optional<unsigned> samples; // per texel, of what is baked
};

// Members are destroyed last to first: renderers before what they read. Any of the renderers may be
// absent, but not both of the first two.
struct Stage {
    std::unique_ptr<ByteSource> bytes;
    std::unique_ptr<MeteredSource> metered; // `bytes`, counted; null without a file
    std::unique_ptr<Decoder> decoder;       // null without a file
    TextureDesc desc;
    std::optional<SphereWindow> window; // of a texture on a sphere
    std::optional<PlanarViews> planar;  // of views of a planar grid of cameras
    std::unique_ptr<TexelSource> texels, original;
    std::unique_ptr<ViewRenderer> compressed, uncompressed, truth;

    // What reading the file has cost so far.
    Traffic traffic() const;
    // The one whose views are written.
    ViewRenderer& subject() const { return compressed ? *compressed : *uncompressed; }
    unsigned renderers() const {
        return (compressed ? 1u : 0u) + (uncompressed ? 1u : 0u) + (truth ? 1u : 0u);
    }
};

// Opens the file of --original, whose texels are read in any order. `desc` describes a raw file.
// Errors: bad_argument (another kind of file); those of open_texture().
Result<std::unique_ptr<TexelSource>> open_original(const std::string& path,
                                                   const TextureDesc& desc);

// Errors: bad_argument, where parts do not belong together; unsupported; those of the files.
Result<Stage> set_up_stage(const StageRequest& request, const RenderOptions& options);

} // namespace tessera
