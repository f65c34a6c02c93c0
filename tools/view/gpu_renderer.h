// Draws views of a compressed file on the GPU.
#pragma once

#include "format/container_reader.h"
#include "format/layers.h"
#include "format/surface_mesh.h"
#include "tools/view/view_renderer.h"

#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// A coarse level of a file and its texels, which are only used while a renderer is made.
struct CoarseLevel {
    LevelEntry level{};
    TexelSource* texels = nullptr;
};

// How and in how much memory the device holds the texels of `reader`.
struct GpuRenderOptions {
    // "load" decodes all tiles into an ordinary texture. "feedback" keeps a cache of the tiles that
    // views sample, from one view to the next. "gpu" is "load" if the budget allows it, and
    // "feedback" otherwise. decoder_glsl/gl_sampled_texture.h explains them.
    std::string via = "feedback";
    unsigned budget_mib = 512;
    // With "feedback": the maximum number of tiles decoded between two frames; 0: no limit.
    unsigned tiles_per_frame = 0;
    // With "feedback": what is drawn where tiles are not decoded yet. Without it, making the renderer
    // decodes every tile.
    CoarseLevel coarse{};
    std::function<Traffic()> traffic{}; // returns what was read so far, for the reports of frames
};

// Draws the same picture as make_texture_renderer(), up to the rounding of the filtering hardware.
// With "feedback", a view is redrawn until none of its tiles is missing. Tiles that do not fit into
// the budget stay coarse, and the view's remark says so. Failed reads (io) are repeated; a view
// fails after three consecutive frames with failed reads.
//
// `reader` must outlive the renderer. Not thread-safe. Errors: unsupported (no device has the
// required features, this build has no GPU support, or the file does not fit into the budget),
// invalid_file, io.
Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(const ContainerReader& reader,
                                                        const SphereWindow& window,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options);

// The same for a mesh. The picture matches make_mesh_renderer() except at silhouettes, which are
// drawn with four samples per pixel. The observer may stand anywhere. `mesh` is only used during
// this call.
Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(const ContainerReader& reader,
                                                        const SurfaceMesh& mesh,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options);

// A layer of a file, opened as a file of its own. The reader outlives the renderer.
struct GpuLayer {
    LayerRole role = LayerRole::diffuse;
    float scale = 1; // the light of a sample of 1
    const ContainerReader* reader = nullptr;
    CoarseLevel coarse{}; // as in GpuRenderOptions
};

// The same for a file with layers; the diffuse one comes first. The picture matches
// make_layered_renderer(). The layers share the budget; `options.coarse` is not used.
Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(std::span<const GpuLayer> layers,
                                                        std::span<const DistantLight> lights,
                                                        const SurfaceMesh& mesh,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options);

} // namespace tessera
