// Tests the extensions of glTF materials: energy, reciprocity, samples against densities.
#include "corpus/trace/reflection.h"
#include "corpus/trace/sheen.h"
#include "corpus/trace/tracer.h"
#include "tests/support/model_files.h"

#include <numbers>

namespace tessera::corpus {
namespace {

using namespace support;

constexpr double two_pi = 2.0 * std::numbers::pi;

struct NamedLobes {
    const char* name;
    Lobes lobes;
};

Lobes coated(const glm::dvec3& diffuse, const glm::dvec3& facing, double alpha) {
    Lobes lobes{diffuse, facing, alpha};
    lobes.has_coats = true;
    lobes.coats.clear_normal = {0, 1, 0};
    return lobes;
}

// One material of each extension, and one with all that reflect.
std::vector<NamedLobes> all_coats() {
    std::vector<NamedLobes> all;
    const glm::dvec3 grey(0.04), white(1.0), none(0.0);
    Lobes clear = coated(white, grey, 0.5);
    clear.coats.clear = 1.0;
    clear.coats.clear_alpha = 0.1;
    all.push_back({"clear coat", clear});
    Lobes clear_metal = coated(none, white, 0.3);
    clear_metal.coats.clear = 0.7;
    clear_metal.coats.clear_alpha = 0.2;
    clear_metal.coats.clear_normal = glm::normalize(glm::dvec3(0.2, 1, 0));
    all.push_back({"clear coat on metal", clear_metal});
    Lobes cloth = coated(white, grey, 0.8);
    cloth.coats.sheen = white;
    cloth.coats.sheen_alpha = 0.25;
    all.push_back({"sheen", cloth});
    Lobes brushed = coated(none, white, 0.09);
    brushed.coats.along_alpha = 0.6;
    brushed.coats.along = glm::normalize(glm::dvec3(1, 0, 1));
    all.push_back({"anisotropy", brushed});
    Lobes film = coated(glm::dvec3(0.5), grey, 0.3);
    film.coats.film = 1.0;
    film.coats.film_ior = 1.8;
    film.coats.film_nanometres = 350.0;
    all.push_back({"film", film});
    Lobes everything = film;
    everything.coats.clear = 0.5;
    everything.coats.clear_alpha = 0.2;
    everything.coats.sheen = glm::dvec3(0.5);
    everything.coats.sheen_alpha = 0.5;
    everything.coats.along_alpha = 0.5;
    everything.coats.along = {1, 0, 0};
    all.push_back({"everything", everything});
    return all;
}

LitPoint point_with(const Lobes& lobes) {
    LitPoint p;
    p.position = {0, 50, 0}; // far from any model
    p.face = p.normal = {0, 1, 0};
    p.lobes = lobes;
    return p;
}

glm::dvec3 direction(double up, double round) {
    const double flat = std::sqrt(1.0 - up * up);
    return {flat * std::cos(round), up, flat * std::sin(round)};
}

// The reflected share of white light, and the integral of the density of samples.
struct ReflectedIntegrals {
    glm::dvec3 light{0.0};
    double density = 0;
};
ReflectedIntegrals reflected_integrals(const LitPoint& p, const glm::dvec3& view, int n = 256) {
    const BothLobes lobes(p, view);
    ReflectedIntegrals sum;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const Thrown t = lobes(direction((j + 0.5) / n, two_pi * (i + 0.5) / n));
            sum.light += t.share * (two_pi / (n * n));
            sum.density += t.density * (two_pi / (n * n));
        }
    return sum;
}

double largest(const glm::dvec3& x) {
    return std::max({x.x, x.y, x.z});
}

TEST(Coats, AddNoLight) {
    for (const auto& [name, lobes] : all_coats())
        for (const double up : {0.1, 0.4, 0.8, 1.0}) {
            const ReflectedIntegrals found =
                reflected_integrals(point_with(lobes), direction(up, 0.3));
            // Where the mirror is bright, the diffuse lobe does not lose as much.
            EXPECT_LT(largest(found.light), 1.02) << name << " " << up;
            EXPECT_GT(largest(found.light), 0.3) << name << " " << up;
            EXPECT_LT(found.density, 1.01) << name << " " << up;
        }
}

// The reflected share does not depend on which of both directions is that of light.
TEST(Coats, AreReciprocal) {
    const glm::dvec3 a = direction(0.3, 0.4), b = direction(0.8, 2.5);
    for (const auto& [name, lobes] : all_coats()) {
        const LitPoint p = point_with(lobes);
        const auto towards = [&](const glm::dvec3& view, const glm::dvec3& l) {
            const SpecularLobe specular{p, view};
            // The clear coat counts the cosine to its own normal, the others that to the surface.
            Lobes bare = lobes;
            bare.coats.clear = 0.0;
            const LitPoint without{p.position, p.face, p.normal, p.emission, bare};
            const glm::dvec3 d = DiffuseLobe{p}(l).share * below_coats(p, view) / l.y;
            if (lobes.coats.clear_normal == p.normal || lobes.coats.clear == 0.0)
                return d + specular(l).share / l.y;
            return d + SpecularLobe{without, view}(l).share / l.y;
        };
        const glm::dvec3 there = towards(a, b), back = towards(b, a);
        EXPECT_NEAR(glm::distance(there, back), 0, 1e-9) << name;
        EXPECT_GT(largest(there), 1e-4) << name;
    }
}

// The mean of samples is the integral, and each cell of directions has as many samples as its
// density says.
TEST(Coats, SamplesFollowTheirDensity) {
    constexpr int columns = 4, rows = 3;
    for (const auto& [name, lobes] : all_coats()) {
        const LitPoint p = point_with(lobes);
        const glm::dvec3 view = direction(0.6, 0.3);
        const BothLobes both(p, view);
        std::array<double, columns * rows + 1> counted{}, expected{};
        const auto cell = [](const glm::dvec3& l) {
            if (l.y <= 0.0)
                return std::size_t{columns * rows};
            const double round = (std::atan2(l.z, l.x) / two_pi + 1.0) * columns;
            return static_cast<std::size_t>(std::min(l.y * rows, rows - 1.0)) * columns +
                   static_cast<std::size_t>(round) % columns;
        };
        constexpr unsigned count = 1 << 14;
        glm::dvec3 mean(0.0);
        for (unsigned i = 0; i < count; ++i) {
            PathRandom random(5, i);
            const glm::dvec3 l = both.sample(random);
            counted[cell(l)] += 1.0 / count;
            if (const Thrown t = both(l); t.density > 0.0)
                mean += t.share / t.density / static_cast<double>(count);
        }
        constexpr int n = 360;
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const glm::dvec3 l = direction((j + 0.5) / n, two_pi * (i + 0.5) / n);
                expected[cell(l)] += both(l).density * (two_pi / (n * n));
            }
        for (std::size_t k = 0; k < columns * rows; ++k)
            EXPECT_NEAR(counted[k], expected[k], 0.012) << name << " " << k;
        EXPECT_NEAR(glm::distance(mean, reflected_integrals(p, view).light), 0, 0.02) << name;
    }
}

// glTF's formula: a clear coat takes what it reflects from a diffuse base.
TEST(Coats, ClearCoatTakesItsShareFromDiffuseLight) {
    Lobes lobes = coated(glm::dvec3(0.5), glm::dvec3(0.0), 0.5);
    lobes.grazing = 0.0;
    const glm::dvec3 view = direction(0.5, 0);
    const double bare = reflected_integrals(point_with(lobes), view).light.x;
    lobes.coats.clear = 1.0;
    lobes.coats.clear_alpha = 1e-3; // so thin that the sum over directions misses it
    double below = 0;
    constexpr int n = 512;
    const LitPoint p = point_with(lobes);
    for (int j = 0; j < n; ++j)
        below +=
            DiffuseLobe{p}(direction((j + 0.5) / n, 0)).share.x * below_coats(p, view) * two_pi / n;
    const double reflected = 0.04 + 0.96 * std::pow(0.5, 5);
    EXPECT_NEAR(below / bare, 1.0 - reflected, 0.005);
}

TEST(Coats, EqualAlphasAreIsotropic) {
    Lobes lobes = coated(glm::dvec3(0.0), glm::dvec3(1.0), 0.3), plain = lobes;
    plain.has_coats = false;
    lobes.coats.along_alpha = 0.3;
    lobes.coats.along = {1, 0, 0};
    const glm::dvec3 view = direction(0.7, 1), l = direction(0.4, 2);
    const LitPoint a = point_with(lobes), b = point_with(plain);
    const Thrown one = SpecularLobe{a, view}(l), other = SpecularLobe{b, view}(l);
    EXPECT_NEAR(one.share.x, other.share.x, 1e-12);
    EXPECT_NEAR(one.density, other.density, 1e-12);
    // A longer alpha spreads light along its direction and not across.
    lobes.coats.along_alpha = 0.9;
    const LitPoint c = point_with(lobes);
    const auto at = [&](double round) {
        return SpecularLobe{c, {0, 1, 0}}(direction(0.7, round)).share.x;
    };
    EXPECT_GT(at(0.0), 3.0 * at(1.5708));
}

TEST(Coats, TableOfSheenAgreesWithItsIntegral) {
    for (const double alpha : {0.05, 0.3, 0.9})
        for (const double nv : {0.05, 0.3, 0.7, 1.0}) {
            const glm::dvec3 view = direction(nv, 0);
            double sum = 0;
            constexpr int n = 300;
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i) {
                    const glm::dvec3 l = direction((j + 0.5) / n, two_pi * (i + 0.5) / n);
                    sum += sheen_lobe(alpha, glm::normalize(l + view).y, l.y, nv) * l.y * two_pi /
                           (n * n);
                }
            EXPECT_NEAR(sheen_albedo(alpha, nv), std::min(sum, 1.0), 0.03) << alpha << " " << nv;
        }
}

// The colours of a film, by the exact sum of all its reflections over the spectrum; only what
// interference changes is coloured. The colour matching functions are those of Wyman, Sloan and
// Shirley (2013).
glm::dvec3 film_by_spectrum(double cosine, double ior, double nanometres, double base) {
    const auto schlick = [](double f, double c) { return f + (1 - f) * std::pow(1 - c, 5); };
    const auto facing = [](double a, double b) { return std::pow((a - b) / (a + b), 2); };
    const auto lobe = [](double x, double m, double s1, double s2) {
        const double t = (x - m) / (x < m ? s1 : s2);
        return std::exp(-0.5 * t * t);
    };
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
    const double base_ior = (1 + std::sqrt(base)) / (1 - std::sqrt(base));
    // Amplitudes change their sign where light comes to a denser medium.
    const double first = -std::sqrt(schlick(facing(ior, 1), cosine));
    const double second =
        std::sqrt(schlick(facing(base_ior, ior), inside)) * (base_ior < ior ? 1.0 : -1.0);
    const double r1 = first * first, r2 = second * second;
    const double mean = (r1 + r2 - 2 * r1 * r2) / (1 - r1 * r2); // without interference
    glm::dvec3 xyz(0.0);
    double white = 0;
    for (double x = 380; x <= 780; x += 1) {
        const glm::dvec3 match{
            1.056 * lobe(x, 599.8, 37.9, 31.0) + 0.362 * lobe(x, 442.0, 16.0, 26.7) -
                0.065 * lobe(x, 501.1, 20.4, 26.2),
            0.821 * lobe(x, 568.8, 46.9, 40.5) + 0.286 * lobe(x, 530.9, 16.3, 31.1),
            1.217 * lobe(x, 437.0, 11.8, 36.0) + 0.681 * lobe(x, 459.0, 26.0, 13.8)};
        const double phase = two_pi * 2 * ior * nanometres * inside / x;
        const double both = 2 * first * second * std::cos(phase);
        xyz += match * ((r1 + r2 + both) / (1 + r1 * r2 + both) - mean);
        white += match.y;
    }
    xyz /= white;
    return mean + glm::dvec3(3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
                             -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
                             0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z);
}

TEST(ThinFilm, AgreesWithTheSpectrum) {
    for (const double nanometres : {150.0, 250.0, 400.0})
        for (const double cosine : {1.0, 0.6})
            for (const double base : {0.04, 0.3}) {
                const glm::dvec3 found =
                    film_reflectance(cosine, 1.8, nanometres, glm::dvec3(base));
                const glm::dvec3 exact =
                    glm::clamp(film_by_spectrum(cosine, 1.8, nanometres, base), 0.0, 1.0);
                for (glm::length_t c = 0; c < 3; ++c)
                    EXPECT_NEAR(found[c], exact[c], 0.04)
                        << nanometres << " " << cosine << " " << base << " " << c;
            }
    // Without a thickness there is no film.
    EXPECT_NEAR(film_reflectance(0.9, 1.8, 0.0, glm::dvec3(0.04)).x, 0.04, 0.01);
}

} // namespace
} // namespace tessera::corpus
