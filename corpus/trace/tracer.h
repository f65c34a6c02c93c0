// Path tracing of the light that arrives at a model and leaves it.
#pragma once

#include "corpus/trace/emitters.h"
#include "corpus/trace/environment.h"
#include "corpus/trace/path_random.h"
#include "corpus/trace/ray_model.h"
#include "corpus/trace/reflection.h"

namespace tessera::corpus {

// Parallel light, which casts sharp shadows.
struct Sun {
    glm::dvec3 direction{0, 1, 0}; // unit vector towards the sun
    glm::dvec3 irradiance{3.0};    // on a surface that faces the sun
};

struct ModelLight {
    std::shared_ptr<const Environment> environment; // never null
    std::optional<Sun> sun{};
    std::vector<ModelLamp> lamps{};
    // The light that an observer sees beyond the model, straight through surfaces that blend and
    // clear walls. Absent: that of the environment.
    std::optional<glm::dvec3> backdrop{};
};

// The light of a lamp that arrives at a place, if nothing is between them.
struct LampLight {
    glm::dvec3 direction{0, 1, 0}; // unit vector towards the lamp
    double distance = std::numeric_limits<double>::infinity();
    glm::dvec3 irradiance{0.0}; // on a surface that faces the lamp
};
LampLight lamp_light(const ModelLamp& lamp, const glm::dvec3& place);

// A model in its light. Each function returns the estimate of one path. Estimates are unbiased with
// two exceptions. Mirrors that are seen indirectly are as rough as the roughest surface before
// them on the path, up to a roughness of 0.3, because otherwise a few paths would be very bright.
// And light passes volumes, which bend it, only along paths that start at the observer: a lamp
// casts a shadow of a glass ball without a bright spot. Clear walls without a volume cast tinted
// shadows. Paths pass surfaces that blend at random, those from the observer in the right shares.
// Immutable and thread-safe.
class Tracer {
public:
    static constexpr double off = 1e-4; // rays start this far off a surface, in world units

    Tracer(std::shared_ptr<const RayModel> model, ModelLight light);

    const RayModel& model() const { return *model_; }
    const ModelLight& light() const { return light_; }
    // Whether triangles of the model emit light.
    bool has_emitters() const { return !emitters_.empty(); }
    // The share of the light from this direction, `reach` away, that reaches the point. It has the
    // colour of clear walls.
    glm::dvec3 unblocked(const LitPoint& point, const glm::dvec3& direction,
                         double reach = std::numeric_limits<double>::infinity()) const;
    // Whether less than half of that light reaches the point.
    bool is_shadowed(const LitPoint& point, const glm::dvec3& direction,
                     double reach = std::numeric_limits<double>::infinity()) const;

    // Diffuse light that leaves the point, without the factor below_coats() of the view.
    glm::dvec3 diffuse(const LitPoint& point, PathRandom& random) const;
    // Specular and transmitted light that leaves along the unit vector `view`, which is on the
    // normal's side.
    glm::dvec3 specular(const LitPoint& point, const glm::dvec3& view, PathRandom& random) const;
    // Specular light from two kinds of samples: `shared` paths, which arrive from directions that
    // do not depend on the view and serve all views of the point, and `own` paths of one view. The
    // sum of specular_of() over all shared paths and of specular_own() over all own paths is the
    // specular light along `view`.
    struct Incoming {
        glm::dvec3 direction{0.0}, light{0.0};
        double density = 0;        // per steradian
        bool leaves_model = false; // meets nothing
    };
    Incoming incoming(const LitPoint& point, PathRandom& random) const;
    // The light of the model alone that reaches the point, from two kinds of samples: its mean is
    // the sum of those of light / density of both. For each one that follows the cosine around the
    // normal, `toward_emitters` go to emitting triangles, which takes a single ray each.
    Incoming incoming_of_model(const LitPoint& point, double toward_emitters,
                               PathRandom& random) const;
    // Precondition: has_emitters().
    Incoming incoming_of_emitters(const LitPoint& point, double toward_emitters,
                                  PathRandom& random) const;
    glm::dvec3 specular_of(const Incoming& incoming, const LitPoint& point, const glm::dvec3& view,
                           double shared, double own) const;
    glm::dvec3 specular_own(const LitPoint& point, const glm::dvec3& view, double shared,
                            double own, PathRandom& random) const;
    // The specular light of the model alone: without that of the environment, the sun and lamps
    // that reaches the point directly.
    glm::dvec3 specular_of_model(const LitPoint& point, const glm::dvec3& view,
                                 PathRandom& random) const;
    // The light of the model that reaches the point from this direction, which is a unit vector
    // above the face.
    glm::dvec3 from_model(const LitPoint& point, const glm::dvec3& direction,
                          PathRandom& random) const;
    // Light from behind the surface that leaves along `view`, if the material lets light pass or
    // blends.
    glm::dvec3 transmitted(const LitPoint& point, const glm::dvec3& view, PathRandom& random) const;
    // All light that leaves the point along `view`.
    glm::dvec3 leaving(const LitPoint& point, const glm::dvec3& view, PathRandom& random) const;

    // The point with its normal bent towards `view` where it would face away.
    static LitPoint facing(LitPoint point, const glm::dvec3& view);

private:
    using Hit = std::optional<ModelPlace>;
    // Where the ray meets the model. It passes surfaces that blend with the probability of their
    // transparency, so that the place found counts as opaque.
    Hit next_hit(const glm::dvec3& origin, const glm::dvec3& direction, PathRandom& random) const;
    // How shared paths choose their directions. The rest follows the cosine around the normal.
    struct Shares {
        double environment = 0.5, emitters = 0.0;
    };

    double shared_density(const LitPoint& point, const glm::dvec3& direction, const Hit& hit) const;
    // The density with which emitters_ samples the direction, whose ray meets `hit`.
    double emitter_density(const glm::dvec3& origin, const glm::dvec3& direction,
                           const Hit& hit) const;
    // Light along a ray that meets `hit`. Its direction was sampled with this density. Without the
    // share of the environment and of emission at `hit` that direct() counts. An infinite density
    // means that direct() was not called. `widest`: the alpha of the widest lobe that the path has
    // met. `beyond`: the light beyond the model if the ray comes straight, through clear walls at
    // most, instead of that of the environment.
    glm::dvec3 arriving(glm::dvec3 origin, glm::dvec3 direction, Hit hit, double density,
                        double widest, PathRandom& random,
                        std::optional<glm::dvec3> beyond = {}) const;
    // The same, plus direct().
    template <class Lobe>
    glm::dvec3 reflected(const LitPoint& point, const Lobe& lobe, const glm::dvec3& sampled,
                         PathRandom& random) const;
    template <class Lobe>
    glm::dvec3 direct(const LitPoint& point, const Lobe& lobe, PathRandom& random) const;
    // The part of direct() that comes from emitting triangles.
    template <class Lobe>
    glm::dvec3 from_emitters(const LitPoint& point, const Lobe& lobe, PathRandom& random) const;

    // Where a ray that came against `view` and passed the surface goes on.
    struct PassedRay {
        glm::dvec3 origin{0.0}, direction{0.0};
        glm::dvec3 share{0.0}; // what is left of its light
        // Of its direction, if direct_from_behind() counts light that comes along it.
        double density = std::numeric_limits<double>::infinity();
        bool is_straight = false; // through a clear wall
    };
    PassedRay pass(const LitPoint& point, const glm::dvec3& view, PathRandom& random) const;
    // The light of direct() that arrives at the other side of a rough wall and leaves along `view`;
    // 0 for other surfaces.
    glm::dvec3 direct_from_behind(const LitPoint& point, const glm::dvec3& view,
                                  PathRandom& random) const;
    // From a place within a volume to where the ray leaves it.
    PassedRay leave_volume(PassedRay ray, const LitPoint& entry, PathRandom& random) const;
    // How often a ray passes instead of being reflected.
    static double passing_chance(const LitPoint& point, const glm::dvec3& view);
    // The share of light that goes straight from the start to what is `reach` away: 1, 0, or what
    // clear walls and surfaces that blend leave.
    glm::dvec3 passing_share(const glm::dvec3& start, const glm::dvec3& direction,
                             double reach) const;

    // Light of the lamps that is not blocked on its way to `start`, times the lobe. Many lamps are
    // sampled.
    template <class Lobe>
    glm::dvec3 lamps(const glm::dvec3& start, const Lobe& lobe, PathRandom& random) const;

    std::shared_ptr<const RayModel> model_;
    ModelLight light_;
    Emitters emitters_;
    Shares shared_;
};

} // namespace tessera::corpus
