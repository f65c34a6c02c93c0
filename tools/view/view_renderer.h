// What an observer sees of a sphere with a 2+2D texture, and of the scene that it was baked from.
#pragma once

#include "codec/decoder.h"
#include "corpus/model_surface/model_truth.h"
#include "corpus/scene.h"
#include "format/metadata.h"
#include "tools/support/traffic.h"
#include "tools/view/camera.h"

#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// RGB, row 0 at the top. unorm8 textures: as displayed, 0..1; half16: scene-linear.
struct View {
    std::uint32_t width = 0, height = 0;
    std::vector<float> rgb;
    std::string remark{}; // what it lacks, for a person; usually empty
};

// One of the frames in which a view appears: coarse where tiles are missing, then sharper.
struct DrawnFrame {
    std::uint32_t touched = 0; // tiles that it samples
    std::uint32_t decoded = 0; // tiles decoded for it, since the frame before
    std::uint32_t coarse = 0;  // of `touched`: were missing, so that it shows their coarse texels
    Traffic traffic;           // since the frame before; in the first one of all, opening included
    std::string trouble{};     // why bytes could not be had since then; empty: none
};

// Told of every frame of a view when it is drawn, the last one included; frames count from 1 in each
// view. picture() reads it back, which takes time. An error ends the view.
using FrameHook = std::function<Status(unsigned number, const DrawnFrame& frame,
                                       const std::function<Result<View>()>& picture)>;

// The device that draws, and what is held in its memory.
struct DeviceUse {
    std::string name;
    std::uint64_t bytes = 0;
};

class ViewRenderer {
public:
    virtual ~ViewRenderer() = default;
    // Errors: bad_argument where the eye is on the wrong side of the sphere; io, invalid_file; runtime, also
    // when interrupted.
    virtual Result<View> render(const Camera& camera) = 0;
    // From now on. Renderers that draw a view at once say nothing.
    virtual void watch(FrameHook) {}
    // Nothing where the CPU draws.
    virtual std::optional<DeviceUse> device_use() const { return std::nullopt; }
};

using corpus::SphereWindow;

// Errors: unsupported, where the texture is not the longitude/latitude, hemisphere map of a sphere.
Result<SphereWindow> sphere_window(const Description& description);

// bad_argument where the camera stands on the side of the sphere that its texture is not seen from.
Status check_side(const SphereWindow& window, const Camera& camera);

struct RenderOptions {
    unsigned threads = 0;                     // 0: all cores; never changes the result
    std::uint64_t cache_bytes = 512ull << 20; // of texels kept between pixels and views
    ProgressFunction progress;                // rows of one view
    unsigned rays = 1;                        // through each pixel of a texture, spread evenly
    // Told before each view which blocks (their numbers, ascending) nearly all of its pixels will
    // need, where reading them one by one would be slow. Not called when empty.
    std::function<Status(std::span<const std::uint64_t> blocks)> foretell{};
};

// Samples the texture by format/sampler.h; grey shows as grey, alpha not at all. Reads blocks of up to `block_extent` texels as pixels need them. `source` must
// outlive it and take boxes in any order. `background`: where a ray misses the sphere.
std::unique_ptr<ViewRenderer>
make_texture_renderer(TexelSource& source, const Extent4& block_extent, const SphereWindow& window,
                      const glm::dvec3& background, const RenderOptions& options);

// The scene itself, ray traced: the mean of `samples` rays spread evenly over each pixel. `window`
// is where the scene's own sphere (corpus::window_radius about the origin) stands in the world, or one in
// the scene that is seen from inside; without one the observer stands anywhere in the scene.
std::unique_ptr<ViewRenderer> make_truth_renderer(corpus::Scene scene,
                                                  const std::optional<SphereWindow>& window,
                                                  unsigned samples, const RenderOptions& options);

// A model, path traced, options.rays through each pixel; each is a mean of light, as paths on their own
// would be a mean of what a display makes of them. `background`: where a ray misses it.
std::unique_ptr<ViewRenderer>
make_model_truth_renderer(std::shared_ptr<const corpus::ModelTruth> truth,
                          const glm::dvec3& background, const RenderOptions& options);

} // namespace tessera
