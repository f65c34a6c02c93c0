// The lobes of layers that look most like the lobes of a material with coats.
#pragma once

#include "corpus/trace/reflection.h"
#include "corpus/trace/tracer.h"

#include <map>
#include <mutex>

namespace tessera::corpus {

// Whether coats change how the place reflects light.
bool reflects_by_coats(const Lobes& lobes);

// Whether the place reflects or passes light otherwise than its lobes without coats, more smoothly than
// a mirror does: the colours of a film on a mirror are as sharp as what it mirrors.
bool differs_by_coats(const Lobes& lobes);

// Layers have diffuse light and one round lobe per place, whose reflectance rises to 1 at grazing
// views. For clear coats, sheen, long highlights and thin films, that lobe and what joins the diffuse
// light are the ones that a display would show with the least error on a ball in the environment:
// least squares over places and views of the ball, for each of several roughnesses. So a coat on
// a rough surface keeps its sharp highlights, and the rough lobe becomes diffuse.
//
// Thread-safe. Which lobes come out does not depend on what was asked before.
class NearestLobes {
public:
    // With the default studio in place of a dark environment.
    explicit NearestLobes(const ModelLight& light);

    // The nearest lobes without coats. Nothing passes.
    Lobes operator()(const Lobes& lobes) const;
    // How many fits that took. Each takes some hundredths of a second, so pictures of noise must not
    // need one for each texel.
    std::size_t fits() const;

private:
    enum class Source : std::uint8_t { fixed, base, clear };
    struct Fit {
        glm::dvec3 diffuse{0.0}, facing{0.0}; // of the rounded lobes
        // How these change with the base's reflectance at normal incidence.
        glm::dvec3 diffuse_slope{0.0}, facing_slope{0.0};
        double roughness = 1.0;
        Source source = Source::fixed; // where the roughness comes from
        double error = 0.0;
    };
    using Key = std::array<std::int16_t, 13>;

    static Lobes rounded(const Lobes& lobes, Key& key);
    Fit fit(const Lobes& lobes) const;

    std::shared_ptr<const Environment> environment_;
    double exposure_ = 1.0; // by which white is as bright in the mean light as `bake` makes it
    mutable std::mutex mutex_;
    mutable std::map<Key, Fit> fits_;
};

} // namespace tessera::corpus
