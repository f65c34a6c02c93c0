// The places of a mesh that photographs show, and the directions in which they show them.
#pragma once

#include "corpus/layers/rows.h"
#include "corpus/photographs/photograph.h"
#include "corpus/photographs/pixel_filter.h"
#include "corpus/trace/ray_scene.h"
#include "format/surface_mesh.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tessera::corpus {

// Where a ray of a pixel meets the mesh.
struct PhotoSample {
    float u, v;   // place in the atlas, 0..1
    float s, t;   // the direction mirrored about the normal, octahedral, 0..1
    float weight; // of the ray in its pixel; the weights of all rays of a pixel add up to 1
};

struct PhotoPixel {
    std::uint32_t x, y;          // from the top left corner
    std::uint32_t begin, end;    // its samples; never none
    float coverage;              // the share of its rays that meet the mesh, above 0
    std::array<float, 3> colour; // RGB as displayed, without the share of the background
    float weight;                // of its error; 0: it does not count
};

// Pixels of several photographs, photograph by photograph, row by row.
struct PhotoSamples {
    std::vector<PhotoSample> samples;
    std::vector<PhotoPixel> pixels;
    std::vector<std::size_t> first; // pixel of each photograph, and the end
    std::size_t photographs() const { return first.size() - 1; }
    std::span<const PhotoSample> of(const PhotoPixel& pixel) const {
        return {samples.data() + pixel.begin, samples.data() + pixel.end};
    }
};

struct PhotoTraceOptions {
    PixelFilter filter;
    unsigned rays = 2;  // along each side of a pixel
    double share = 1.0; // of the pixels, spread evenly; 0..1
    // The colour where the mesh is not seen, in display values. Without one, pixels count only where
    // the mesh covers them and their neighbours.
    std::optional<glm::dvec3> background;
    BakeRun run;
};

// A mesh that is seen from its front. Immutable and thread-safe.
class SeenMesh {
public:
    // Error: runtime, from Embree.
    static Result<SeenMesh> make(SurfaceMesh mesh);
    const SurfaceMesh& mesh() const { return mesh_; }
    std::optional<RayHit> first_hit(const glm::dvec3& eye, const glm::dvec3& direction) const {
        return rays_.first_hit(eye, direction);
    }
    // The sample of a hit, with weight 1.
    PhotoSample sample(const RayHit& hit, const glm::dvec3& direction) const;

private:
    SeenMesh(SurfaceMesh mesh, RayScene rays)
        : mesh_(std::move(mesh)), tangents_(mesh_tangents(mesh_)), rays_(std::move(rays)) {}

    SurfaceMesh mesh_;
    std::vector<glm::vec3> tangents_;
    RayScene rays_;
};

// The colour that all borders of some of the photographs have; nothing if they differ. Errors: those
// of read_photograph().
Result<std::optional<glm::dvec3>> common_background(std::span<const PosedPhotograph> photographs);

// Traces rays through all photographs. The result depends only on the arguments. Takes 24 bytes per
// ray that meets the mesh. Errors: those of read_photograph() and for_rows(); bad_argument if no
// photograph sees the mesh; unsupported (more than 2^32 samples).
Result<PhotoSamples> trace_photographs(const SeenMesh& mesh,
                                       std::span<const PosedPhotograph> photographs,
                                       const PhotoTraceOptions& options);

} // namespace tessera::corpus
