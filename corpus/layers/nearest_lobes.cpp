#include "corpus/layers/nearest_lobes.h"

#include "corpus/trace/path_random.h"

#include <array>
#include <cmath>

namespace tessera::corpus {
namespace {

constexpr unsigned ball_views = 192; // pairs of a place of the ball and a view of it
constexpr unsigned towards_light = 64, in_lobe = 48, around_normal = 16; // samples of each
constexpr std::uint64_t ball_sequence = 0x62616C6C;
constexpr std::array<double, 12> roughnesses{0.05, 0.1, 0.15, 0.2, 0.3, 0.4,
                                             0.5,  0.6, 0.7,  0.8, 0.9, 1.0};
constexpr double slope_step = 0.25; // of reflectance, for the slopes

// What a round lobe shows in a view, of reflectance 1 without and for the Fresnel factor.
struct RoundView {
    glm::dvec3 facing{0.0}, grazing{0.0};
};

// What a view of a place of the ball shows in the environment.
struct BallView {
    glm::dvec3 wanted{0.0};       // of all lobes
    glm::dvec3 slope{0.0};        // how this changes with the base's reflectance
    glm::dvec3 diffuse{0.0};      // of a white diffuse surface
    std::vector<RoundView> round; // for each of the tried roughnesses
};

struct BallSample {
    glm::dvec3 direction{0.0}, light{0.0}; // divided by the density of the samples
};

// How much a display shows of the difference of two lights, per unit of light.
double display_slope(double light, double other) {
    constexpr double least = 1e-3;
    if (std::abs(other - light) < least)
        other = light + least;
    return (linear_to_srgb(other) - linear_to_srgb(light)) / (other - light);
}

std::vector<BallSample> ball_samples(const Environment& environment, const SpecularLobe& lobe,
                                     PathRandom& random) {
    constexpr unsigned count = towards_light + in_lobe + around_normal;
    const glm::dvec3& n = lobe.p.normal;
    std::vector<BallSample> samples;
    for (unsigned i = 0; i < count; ++i) {
        glm::dvec3 l;
        if (i < towards_light)
            l = environment.sample(random.next2()).direction;
        else if (i < towards_light + in_lobe)
            l = lobe.sample(random);
        else
            l = sample_cosine(n, random.next2());
        const double nl = glm::dot(n, l);
        if (nl <= 0.0)
            continue;
        const double density = towards_light * environment.density(l) + in_lobe * lobe(l).density +
                               around_normal * cosine_density(nl);
        if (density > 0.0)
            samples.push_back({l, environment.light(l) / density});
    }
    return samples;
}

RoundView round_view(const std::vector<BallSample>& samples, const glm::dvec3& n,
                     const glm::dvec3& view, double roughness) {
    const double alpha = roughness * roughness, nv = glm::dot(n, view);
    RoundView seen;
    for (const BallSample& sample : samples) {
        const glm::dvec3& l = sample.direction;
        const glm::dvec3 h = glm::normalize(l + view);
        const double nl = glm::dot(n, l), rise = fifth(1.0 - glm::dot(view, h));
        const glm::dvec3 light = sample.light * (ggx(alpha, std::min(glm::dot(n, h), 1.0)) *
                                                 smith_visibility(alpha, nl, nv) * nl);
        seen.facing += (1.0 - rise) * light;
        seen.grazing += rise * light;
    }
    return seen;
}

// Diffuse light and reflectance of the round lobe in one channel.
struct Pair {
    double diffuse = 0, facing = 0;
};

// Weighted sums of least squares for both.
struct PairSums {
    double dd = 1e-12, df = 0, ff = 1e-12;
    Pair right, slope;

    void add(double weight, double d, double f, double wanted, double change) {
        dd += weight * d * d;
        df += weight * d * f;
        ff += weight * f * f;
        right.diffuse += weight * d * wanted;
        right.facing += weight * f * wanted;
        slope.diffuse += weight * d * change;
        slope.facing += weight * f * change;
    }
    Pair solve(const Pair& b) const {
        const double determinant = dd * ff - df * df + 1e-12;
        return {(b.diffuse * ff - b.facing * df) / determinant,
                (b.facing * dd - b.diffuse * df) / determinant};
    }
    // With a reflectance in 0..1 and diffuse light that is not negative.
    Pair best() const {
        Pair x = solve(right);
        if (x.diffuse < 0.0)
            x = {0.0, right.facing / ff};
        if (x.facing < 0.0 || x.facing > 1.0) {
            x.facing = std::clamp(x.facing, 0.0, 1.0);
            x.diffuse = std::max((right.diffuse - x.facing * df) / dd, 0.0);
        }
        return x;
    }
};

// The pair for one roughness that a display shows with the least error, with its slopes.
struct PairFit {
    Pair best, slope;
    double error = 0;
};
PairFit fit_pair(const std::vector<BallView>& views, std::size_t roughness, glm::length_t c,
                 double exposure) {
    constexpr int rounds = 5;
    PairFit fit;
    for (int i = 0; i <= rounds; ++i) {
        PairSums sums;
        fit.error = 0;
        for (const BallView& view : views) {
            const RoundView& round = view.round[roughness];
            const double wanted = view.wanted[c], d = view.diffuse[c], f = round.facing[c];
            const double all = exposure * wanted;
            const double shown =
                i == 0 ? all
                       : exposure * (round.grazing[c] + fit.best.diffuse * d + fit.best.facing * f);
            const double slope = display_slope(all, shown);
            const double error = slope * (shown - all);
            fit.error += error * error;
            sums.add(slope * slope, d, f, wanted - round.grazing[c], view.slope[c]);
        }
        if (i == rounds)
            break;
        fit.best = sums.best();
        fit.slope = sums.solve(sums.slope);
    }
    return fit;
}

// The view of this number.
BallView ball_view(const Environment& environment, const Lobes& lobes,
                   const std::vector<double>& tried, unsigned number) {
    PathRandom random(ball_sequence, number);
    LitPoint p;
    p.lobes = lobes;
    const glm::dvec2 on_ball = random.next2();
    const double up = 2.0 * on_ball.x - 1.0, flat = std::sqrt(1.0 - up * up);
    const double around = 2.0 * std::numbers::pi * on_ball.y;
    p.normal = p.face = {flat * std::cos(around), up, flat * std::sin(around)};
    p.lobes.coats.clear_normal = p.normal;
    const glm::dvec3 view = sample_cosine(p.normal, random.next2());
    const double turn = 2.0 * std::numbers::pi * random.next();
    const glm::dvec3 x = any_tangent(p.normal), y = glm::cross(p.normal, x);
    p.lobes.coats.along = x * std::cos(turn) + y * std::sin(turn);
    LitPoint brighter = p;
    brighter.lobes.facing += slope_step;
    const SpecularLobe lobe{p, view}, brighter_lobe{brighter, view};
    const DiffuseLobe diffuse{p};
    const double below = below_coats(p, view);
    const std::vector<BallSample> samples = ball_samples(environment, lobe, random);
    BallView seen;
    for (const BallSample& sample : samples) {
        const glm::dvec3 light = lobe(sample.direction).share * sample.light;
        const glm::dvec3 more = brighter_lobe(sample.direction).share * sample.light;
        seen.wanted += light + diffuse(sample.direction).share * below * sample.light;
        seen.slope += (more - light) / slope_step;
        seen.diffuse +=
            sample.light * (glm::dot(p.normal, sample.direction) * 0.96 / std::numbers::pi);
    }
    for (const double roughness : tried)
        seen.round.push_back(round_view(samples, p.normal, view, roughness));
    return seen;
}

// The mean over all directions.
double mean_light(const Environment& environment) {
    constexpr unsigned count = 1024;
    double sum = 0;
    for (unsigned i = 0; i < count; ++i) {
        PathRandom random(ball_sequence, i);
        const LightSample at = environment.sample(random.next2());
        if (at.density > 0.0)
            sum += (at.light.x + at.light.y + at.light.z) / (3.0 * at.density);
    }
    return sum / (4.0 * std::numbers::pi * count);
}

} // namespace

bool reflects_by_coats(const Lobes& lobes) {
    const Coats& coats = lobes.coats;
    return lobes.has_coats && (coats.clear > 0.0 || coats.sheen != glm::dvec3(0.0) ||
                               coats.along_alpha > 0.0 || coats.film > 0.0);
}

bool differs_by_coats(const Lobes& lobes) {
    constexpr double sharp_alpha = 0.0225; // a roughness of 0.15
    const Coats& coats = lobes.coats;
    if (lobes.has_coats && coats.through != glm::dvec3(0.0))
        return true;
    const bool only_film =
        !(coats.clear > 0.0 || coats.along_alpha > 0.0) && coats.sheen == glm::dvec3(0.0);
    return reflects_by_coats(lobes) && !(only_film && lobes.alpha < sharp_alpha);
}

NearestLobes::NearestLobes(const ModelLight& light) : environment_(light.environment) {
    constexpr double dark = 1e-6, white = 0.6;
    if (mean_light(*environment_) < dark)
        environment_ = std::make_shared<const Environment>(Environment::studio());
    exposure_ = white / mean_light(*environment_);
}

// Lobes of textured materials are rounded in coarse steps, and the base to grey, so that few need a fit,
// even of noise. The slopes correct most of the rounding.
Lobes NearestLobes::rounded(const Lobes& lobes, Key& key) {
    std::size_t next = 0;
    const auto round = [&](double& x, double steps) {
        const double step = std::round(x * steps);
        key[next++] = static_cast<std::int16_t>(std::clamp(step, -32000.0, 32000.0));
        x = step / steps;
    };
    const auto round_alpha = [&](double& alpha) {
        double roughness = std::sqrt(alpha);
        round(roughness, 10.0);
        alpha = std::max(roughness * roughness, 1e-6);
    };
    const auto round_root = [&](double& x, double steps) {
        double root = std::sqrt(x);
        round(root, steps);
        x = root * root;
    };
    const auto round_grey = [&](glm::dvec3& colour, double steps) {
        double grey = (colour.x + colour.y + colour.z) / 3.0;
        round_root(grey, steps);
        colour = glm::dvec3(grey);
    };
    key = {};
    Lobes out = lobes;
    Coats& coats = out.coats;
    round_grey(out.diffuse, 4.0);
    round_grey(out.facing, 5.0);
    round(out.grazing, 4.0);
    round_alpha(out.alpha);
    round(coats.clear, 4.0);
    round_alpha(coats.clear_alpha);
    for (glm::length_t c = 0; c < 3; ++c)
        round_root(coats.sheen[c], 6.0);
    round_alpha(coats.sheen_alpha);
    if (coats.along_alpha > 0.0)
        round_alpha(coats.along_alpha);
    round(coats.film, 4.0);
    round(coats.film_nanometres, 1.0 / 32.0);
    return out;
}

std::size_t NearestLobes::fits() const {
    const std::scoped_lock lock(mutex_);
    return fits_.size();
}

NearestLobes::Fit NearestLobes::fit(const Lobes& lobes) const {
    std::vector<double> tried(roughnesses.begin(), roughnesses.end());
    tried.push_back(std::sqrt(lobes.alpha));
    if (lobes.coats.clear > 0.0)
        tried.push_back(std::sqrt(lobes.coats.clear_alpha));
    std::vector<BallView> views;
    for (unsigned i = 0; i < ball_views; ++i)
        views.push_back(ball_view(*environment_, lobes, tried, i));
    const double below = mean_below_coats(lobes.coats);
    Fit best;
    best.error = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < tried.size(); ++k) {
        Fit found;
        found.roughness = tried[k];
        for (glm::length_t c = 0; c < 3; ++c) {
            const PairFit pair = fit_pair(views, k, c, exposure_);
            found.diffuse[c] = pair.best.diffuse - lobes.diffuse[c] * below;
            found.facing[c] = pair.best.facing;
            found.diffuse_slope[c] = pair.slope.diffuse;
            found.facing_slope[c] = pair.slope.facing;
            found.error += pair.error;
        }
        if (k >= roughnesses.size())
            found.source = k == roughnesses.size() ? Source::base : Source::clear;
        if (found.error < best.error)
            best = found;
    }
    return best;
}

Lobes NearestLobes::operator()(const Lobes& lobes) const {
    if (!reflects_by_coats(lobes))
        return without_coats(lobes);
    Key key;
    const Lobes about = rounded(lobes, key);
    const Fit found = [&] {
        {
            const std::scoped_lock lock(mutex_);
            if (const auto at = fits_.find(key); at != fits_.end())
                return at->second;
        }
        const Fit made = fit(about);
        const std::scoped_lock lock(mutex_);
        return fits_.emplace(key, made).first->second;
    }();
    Lobes bare = without_coats(lobes);
    const double below = mean_below_coats(lobes.coats);
    const glm::dvec3 change = lobes.facing - about.facing;
    bare.diffuse =
        glm::max(lobes.diffuse * below + found.diffuse + found.diffuse_slope * change, 0.0);
    bare.facing = glm::clamp(found.facing + found.facing_slope * change, 0.0, 1.0);
    bare.grazing = 1.0;
    double roughness = found.roughness;
    if (found.source == Source::base)
        roughness = std::sqrt(lobes.alpha);
    else if (found.source == Source::clear)
        roughness = std::sqrt(lobes.coats.clear_alpha);
    bare.alpha = roughness * roughness;
    return bare;
}

} // namespace tessera::corpus
