// The light that leaves each texel of a model's atlas.
#pragma once

#include "corpus/model_surface/model_places.h"
#include "corpus/trace/tracer.h"

namespace tessera::corpus {

struct LitModelOptions {
    unsigned samples = 16;          // paths per texel, for light that depends on the direction
    unsigned diffuse_samples = 256; // paths per place, for diffuse light
    unsigned shared_samples = 128;  // more paths per place, which all its directions share
    std::uint64_t seed = 1;
    unsigned threads = 1; // for diffuse light; does not change the result
};

// All texels have the same random paths. So the remaining noise varies slowly over the texture and
// costs few bits. Immutable and thread-safe. Memory: 20 bytes per texel of U x V.
class LitModel {
public:
    // Bakes the diffuse light. Errors: bad_argument (samples); those of TexelPlaces::make() and
    // RayModel::make().
    static Result<std::shared_ptr<const LitModel>> make(ModelAtlas atlas, ModelLight light,
                                                        const LitModelOptions& options);

    const TexelPlaces& places() const { return places_.texel_places(); }
    bool matters(std::uint32_t u, std::uint32_t v) const {
        return places().matters(u, v) && !hidden_[index(u, v)];
    }
    // The frame at the texel's centre. Precondition: places().matters(u, v).
    SurfaceFrame frame(std::uint32_t u, std::uint32_t v) const {
        return places_.place(u, v, {0.0, 0.0}).frame;
    }
    // The light that arrives at places of a texel, for all its directions.
    struct Arriving;
    std::shared_ptr<const Arriving> arriving(std::uint32_t u, std::uint32_t v) const;
    // The linear light that leaves the texel along (s, t) of the map: the mean over the texel. A
    // direction into the surface stands for its mirror image above the surface. `arriving` is
    // arriving(u, v).
    glm::dvec3 light(std::uint32_t u, std::uint32_t v, AngularMap map, double s, double t,
                     const Arriving& arriving) const;
    // The same from other random paths, also for diffuse light. The difference is noise.
    glm::dvec3 other_light(std::uint32_t u, std::uint32_t v, AngularMap map, double s, double t,
                           std::uint64_t seed) const;

private:
    LitModel(ModelPlaces places, ModelLight light, const LitModelOptions& options);

    std::size_t index(std::uint32_t u, std::uint32_t v) const {
        return std::size_t{v} * places().size()[0] + u;
    }
    glm::dvec3 diffuse(std::uint32_t u, std::uint32_t v, std::uint64_t seed) const;
    glm::dvec3 light_with(std::uint32_t u, std::uint32_t v, AngularMap map, double s, double t,
                          const glm::dvec3& diffuse, const Arriving& arriving,
                          std::uint64_t seed) const;
    std::shared_ptr<const Arriving> arriving_with(std::uint32_t u, std::uint32_t v,
                                                  std::uint64_t seed) const;
    void bake_rows(std::uint32_t begin, std::uint32_t step);

    ModelPlaces places_;
    Tracer tracer_;
    LitModelOptions options_;
    std::vector<glm::vec3> diffuse_;   // of each texel
    std::vector<std::uint8_t> hidden_; // of each texel: inside a body
};

} // namespace tessera::corpus
