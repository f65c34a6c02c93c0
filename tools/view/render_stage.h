// Sets up the renderers of `tessera render`: those of a compressed file or a scene's texture, of
// the uncompressed texture, and of the ray-traced truth.
#pragma once

#include "codec/decoder.h"
#include "tools/support/traffic.h"
#include "tools/view/layer_files.h"
#include "tools/view/planar_renderer.h"
#include "tools/view/view_renderer.h"

#include <memory>
#include <optional>
#include <string>

namespace tessera {

struct StageRequest {
    // Either a .tess file, or the name of a built-in scene, whose texels are baked when they are
    // needed. The other one is empty.
    std::string file, scene;
    // The bytes of the file, if it is in memory; then `file` only names it in messages.
    std::span<const std::byte> bytes{};
    std::string texture_size; // of the scene's texture, "UxVxSxT"; empty: the scene's default
    DecodeOptions decode;
    std::string via = "cpu";      // cpu, gpu, load or feedback
    unsigned budget_mib = 512;    // GPU memory for texels
    unsigned tiles_per_frame = 0; // with feedback, see gpu_renderer.h
    std::optional<unsigned> rays; // per pixel, on the CPU; default: 1 for a sphere, 4 for a mesh
    std::optional<double> focus;  // of planar views: distance from their cameras
    // The scene or model file to trace as the truth; empty: none.
    std::string truth;
    // The environment map of a model's truth; empty: the path in the file's metadata.
    std::string truth_environment;
    // Per pixel; default: 16 rays for a scene, 512 paths for a model.
    std::optional<unsigned> truth_samples;
    std::string original;            // the file with the uncompressed texture; empty: none
    std::optional<unsigned> samples; // rays per texel where texels are baked
};

// Members are destroyed from last to first, so renderers are destroyed before their sources. Each
// renderer may be absent, but at least one of `compressed` and `uncompressed` is present.
struct Stage {
    std::unique_ptr<ByteSource> bytes;
    std::unique_ptr<MeteredSource> metered; // counts reads of `bytes`; null without a file
    std::unique_ptr<Decoder> decoder;       // null without a file
    TextureDesc desc;
    std::optional<SphereWindow> window; // present for textures on spheres
    std::optional<PlanarViews> planar;  // present for planar views
    ViewFrame frame;                    // of the poses that see all of the texture
    std::unique_ptr<TexelSource> texels, original;
    std::vector<OpenLayerFile> layers; // besides the file's own texture
    std::vector<std::unique_ptr<TexelSource>> layer_texels;
    std::unique_ptr<ViewRenderer> compressed, uncompressed, truth;

    // A camera of photographs in the coordinates of the texture, which differ for planar views that
    // were fitted to photographs.
    Camera in_texture(const Camera& camera) const {
        return planar && planar->place ? seen_from_window(*planar->place, camera) : camera;
    }
    // The reads of the file so far.
    Traffic traffic() const;
    // The renderer whose views are written.
    ViewRenderer& subject() const { return compressed ? *compressed : *uncompressed; }
    unsigned renderers() const {
        return (compressed ? 1u : 0u) + (uncompressed ? 1u : 0u) + (truth ? 1u : 0u);
    }
};

// Opens the file of --original. A raw file is read as `desc` describes it. Errors: bad_argument
// (neither a raw nor a .tess file) and those of open_texture().
Result<std::unique_ptr<TexelSource>> open_original(const std::string& path,
                                                   const TextureDesc& desc);

// Errors: bad_argument (options or files that do not fit together), unsupported, and those of
// opening the files.
Result<Stage> set_up_stage(const StageRequest& request, const RenderOptions& options);

} // namespace tessera
