// Renders views of a texture on a sphere, and ray-traced views of the scene or model that a texture
// was baked from.
#pragma once

#include "codec/decoder.h"
#include "corpus/model_surface/model_truth.h"
#include "corpus/photographs/pixel_filter.h"
#include "corpus/scene.h"
#include "format/metadata.h"
#include "format/surface_mesh.h"
#include "tools/support/traffic.h"
#include "tools/view/camera.h"

#include <array>
#include <functional>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// A picture, row by row from the top. Values of unorm8 textures are display values in 0..1, those
// of half16 textures are scene-linear.
struct View {
    std::uint32_t width = 0, height = 0; // pixels
    std::vector<float> rgb;              // three values per pixel
    std::string remark{};                // a message for the user, such as what is drawn coarsely
};

// One of the frames of a view. The first ones are coarse where tiles are missing, later ones
// sharper.
struct DrawnFrame {
    std::uint32_t touched = 0; // number of tiles that it samples
    std::uint32_t decoded = 0; // number of tiles decoded since the previous frame
    std::uint32_t coarse = 0;  // how many of `touched` are missing and drawn coarsely
    Traffic traffic;       // since the previous frame; the first frame includes opening the file
    std::string trouble{}; // the read error since the previous frame; empty: none
};

// Called after every frame of a view, including the last one. Frames are numbered from 1 within
// each view. picture() reads the frame back, which is slow. If the hook returns an error, drawing
// the view fails with that error.
using FrameHook = std::function<Status(unsigned number, const DrawnFrame& frame,
                                       const std::function<Result<View>()>& picture)>;

// The device that draws, and how much of its memory the renderer uses.
struct DeviceUse {
    std::string name;
    std::uint64_t bytes = 0;
};

class ViewRenderer {
public:
    virtual ~ViewRenderer() = default;
    // Errors: bad_argument (the eye is on the wrong side of the sphere or window), io,
    // invalid_file, runtime (also when interrupted).
    virtual Result<View> render(const Camera& camera) = 0;
    // The values, like those of a view, that leave a mesh at each point, as the mean over the
    // observers around it (mean_views()); and in w, how much of the surface is there, 0 to 1.
    // A point stands for `covered` of the atlas along u and v, as a share of the whole.
    // Thread-safe. Errors: unsupported (no mesh, or drawn on the GPU), io, invalid_file.
    virtual Result<std::vector<glm::dvec4>> mean_values(std::span<const SurfacePoint> points,
                                                        const glm::dvec2& covered);
    // Calls the hook for the frames of all further views. Renderers that draw a view in one go
    // never call it.
    virtual void watch(FrameHook) {}
    // Nothing for renderers on the CPU.
    virtual std::optional<DeviceUse> device_use() const { return std::nullopt; }
};

// Unit vectors from a surface to observers all around it, more of them where they see more of it:
// their density is that of the cosine to the normal.
inline constexpr std::size_t mean_view_count = 16;
std::array<glm::dvec3, mean_view_count> mean_views(const SurfaceFrame& frame);

using corpus::SphereWindow;

// The sphere that a texture lies on. Errors: unsupported if the texture is not on a sphere with the
// longitude/latitude and hemisphere maps.
Result<SphereWindow> sphere_window(const Description& description);

// Returns bad_argument if the camera is on the side of the sphere where the texture is not visible.
Status check_side(const SphereWindow& window, const Camera& camera);

struct RenderOptions {
    unsigned threads = 0;                     // 0: all cores; does not affect the picture
    std::uint64_t cache_bytes = 512ull << 20; // of texels kept between pixels and between views
    ProgressFunction progress;                // called with the rows of one view
    unsigned rays = 1;                        // per pixel, spread evenly
    // Called before each view, if set, with the numbers of the blocks that nearly all of its pixels
    // need, in ascending order. A source that is slow to read can fetch them together.
    std::function<Status(std::span<const std::uint64_t> blocks)> foretell{};
    corpus::PixelFilter filter{}; // where the rays of a pixel go
};

// Renders a texture on a sphere, sampled as in format/sampler.h. Ignores alpha. Reads blocks of up
// to `block_extent` texels when pixels need them. `source` must outlive the renderer and read boxes
// in any order. `background` is the colour of rays that miss the sphere.
std::unique_ptr<ViewRenderer>
make_texture_renderer(TexelSource& source, const Extent4& block_extent, const SphereWindow& window,
                      const glm::dvec3& background, const RenderOptions& options);

// Ray traces a scene. Each pixel is the mean of `samples` evenly spread rays. `window` is the
// sphere of the texture. If it is seen from outside, the scene is moved and scaled so that its own
// sphere (corpus::window_radius around the origin) coincides with it. If it is seen from inside, it
// is a sphere within the scene. Without a window the observer may stand anywhere in the scene.
std::unique_ptr<ViewRenderer> make_truth_renderer(corpus::Scene scene,
                                                  const std::optional<SphereWindow>& window,
                                                  unsigned samples, const RenderOptions& options);

// Path traces a model with options.rays rays per pixel. Each ray averages the light of several
// paths and then converts the mean to display values; converting every path would give another
// mean. `frame` is that of the cameras. `background` is the colour of rays that miss the model.
std::unique_ptr<ViewRenderer>
make_model_truth_renderer(std::shared_ptr<const corpus::ModelTruth> truth,
                          const corpus::ModelFrame& frame, const glm::dvec3& background,
                          const RenderOptions& options);

} // namespace tessera
