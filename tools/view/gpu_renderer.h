// Views of a compressed file drawn on the GPU.
#pragma once

#include "format/container_reader.h"
#include "format/surface_mesh.h"
#include "tools/view/view_renderer.h"

#include <glm/vec3.hpp>
#include <memory>
#include <string>

namespace tessera {

// How the texels of `reader` are held on the device, and in how much of its memory.
struct GpuRenderOptions {
    // As decoder_glsl/gl_sampled_texture.h explains: "load", all tiles decoded into an ordinary
    // texture; "feedback", a cache of the tiles that views touch, kept from one view to the next;
    // "gpu", the first of them that the budget has room for.
    std::string via = "feedback";
    unsigned budget_mib = 512;
    unsigned tiles_per_frame = 0; // on feedback: most that are decoded between two frames; 0: all
    // On feedback: one of the file's coarse levels and its texels, for frames that come before their
    // tiles. Needed until the renderer is made. Without it, making one decodes every tile.
    LevelEntry coarse_level{};
    TexelSource* coarse_texels = nullptr;
    std::function<Traffic()> traffic{}; // what reading has cost so far, for frames to tell
};

// The same picture as make_texture_renderer() within what filtering hardware rounds. On feedback a
// view is drawn anew until nothing that it touches is missing; tiles that the budget has no room
// for stay coarse, and the view's remark says so. What could not be read (io) is asked for again, at
// the third frame in a row that could not read something the view fails.
//
// `reader` must outlive it. One thread. Errors: unsupported (no device offers what it takes; this
// build has no GPU host; the file does not fit into the budget this way), invalid_file, io.
Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(const ContainerReader& reader,
                                                        const SphereWindow& window,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options);

// The same of a mesh: the picture of make_mesh_renderer() but for silhouettes, of which it takes four
// samples a pixel. The observer may stand anywhere. `mesh` is used here only.
Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(const ContainerReader& reader,
                                                        const SurfaceMesh& mesh,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options);

} // namespace tessera
