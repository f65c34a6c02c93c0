// A model on its atlas in its light: what leaves each place.
#pragma once

#include "corpus/model_surface/model_atlas.h"
#include "corpus/surface/texel_places.h"
#include "corpus/trace/tracer.h"

namespace tessera::corpus {

struct LitModelOptions {
    unsigned samples = 16;          // paths a texel, for what depends on the direction
    unsigned diffuse_samples = 256; // paths a place, for what does not
    unsigned shared_samples =
        128; // paths a place whose light all directions share, beside their own
    std::uint64_t seed = 1;
    unsigned threads = 1; // for diffuse light; never changes it
    // Whether each texel has paths of its own. Else all have the same: what is left of their noise
    // varies slowly over the texture, and costs few bits.
    bool own_paths = false;
};

// Immutable, hence thread-safe. Memory: 20 bytes a texel of U x V.
class LitModel {
public:
    // Bakes diffuse light at once. Errors: those of TexelPlaces and RayModel.
    static Result<std::shared_ptr<const LitModel>> make(ModelAtlas atlas, ModelLight light,
                                                        const LitModelOptions& options);

    const TexelPlaces& places() const { return places_; }
    const SurfaceMesh& mesh() const { return mesh_; }
    bool matters(std::uint32_t u, std::uint32_t v) const {
        return places_.matters(u, v) && !hidden_[index(u, v)];
    }
    // Of the texel's centre. Precondition: places().matters(u, v).
    SurfaceFrame frame(std::uint32_t u, std::uint32_t v) const;
    // Linear light that leaves the texel along (s, t) of the map, mean over the texel. Where that
    // points into the surface, what leaves along the mirror image above it.
    glm::dvec3 light(std::uint32_t u, std::uint32_t v, AngularMap map, double s, double t) const;
    // Light that arrives at a texel's places: what all its directions share.
    struct Arriving;
    std::shared_ptr<const Arriving> arriving(std::uint32_t u, std::uint32_t v) const;
    glm::dvec3 light(std::uint32_t u, std::uint32_t v, AngularMap map, double s, double t,
                     const Arriving& arriving) const;
    // The same from other paths, diffuse light included: what differs is noise.
    glm::dvec3 other_light(std::uint32_t u, std::uint32_t v, AngularMap map, double s, double t,
                           std::uint64_t seed) const;

private:
    struct Place {
        LitPoint point;
        SurfaceFrame frame;
    };

    LitModel(ModelAtlas atlas, std::shared_ptr<const RayModel> model, ModelLight light,
             const LitModelOptions& options, TexelPlaces places);

    std::size_t index(std::uint32_t u, std::uint32_t v) const {
        return std::size_t{v} * places_.size()[0] + u;
    }
    std::uint64_t sequence(std::uint32_t u, std::uint32_t v, std::uint64_t seed) const;
    Place place(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const;
    glm::dvec3 diffuse(std::uint32_t u, std::uint32_t v, std::uint64_t seed) const;
    glm::dvec3 light_with(std::uint32_t u, std::uint32_t v, AngularMap map, double s, double t,
                          const glm::dvec3& diffuse, const Arriving& arriving,
                          std::uint64_t seed) const;
    std::shared_ptr<const Arriving> arriving_with(std::uint32_t u, std::uint32_t v,
                                                  std::uint64_t seed) const;
    bool is_hidden(std::uint32_t u, std::uint32_t v) const;
    void bake_rows(std::uint32_t begin, std::uint32_t step);

    SurfaceMesh mesh_;
    std::vector<glm::vec3> tangents_;
    TexelPlaces places_;
    Tracer tracer_;
    LitModelOptions options_;
    std::vector<glm::vec3> diffuse_;   // a texel; emission, too
    std::vector<std::uint8_t> hidden_; // a texel: inside of something
};

} // namespace tessera::corpus
