#include "corpus/pattern.h"

namespace tessera::corpus {
namespace {

struct Cell {
    std::int64_t x, y, z;
};

// An inline floor(). Without SSE 4.1 std::floor is a function call, and a ray needs about 10.
std::int64_t cell_of(double q) {
    const auto truncated = static_cast<std::int64_t>(q);
    return truncated - (q < static_cast<double>(truncated) ? 1 : 0);
}
Cell cell_of(const glm::dvec3& q) {
    return {cell_of(q.x), cell_of(q.y), cell_of(q.z)};
}

// The keys of neighbouring cells differ by these multipliers.
constexpr std::uint64_t key_x = 0x8DA6B343D8163841u;
constexpr std::uint64_t key_y = 0xD8163841CB1AB31Fu;
constexpr std::uint64_t key_z = 0xCB1AB31F8DA6B343u;

std::uint64_t key_of(const Cell& c) {
    return static_cast<std::uint64_t>(c.x) * key_x + static_cast<std::uint64_t>(c.y) * key_y +
           static_cast<std::uint64_t>(c.z) * key_z;
}

// A uniform number in 0..1. Noise needs only one round of mixing.
double value_of(std::uint64_t key) {
    const std::uint64_t mixed = (key ^ (key >> 29)) * 0xBF58476D1CE4E5B9u;
    return static_cast<double>(static_cast<std::int64_t>((mixed ^ (mixed >> 32)) & 0xFFFFFFu)) *
           0x1p-24;
}

double cell_value(const Cell& c) {
    return value_of(key_of(c));
}

double lerp(double a, double b, double w) {
    return a + (b - a) * w;
}
double ease(double f) {
    return f * f * (3.0 - 2.0 * f);
}

double one_octave(const glm::dvec3& q) {
    const Cell c = cell_of(q);
    const double fx = ease(q.x - static_cast<double>(c.x));
    const double fy = ease(q.y - static_cast<double>(c.y));
    const double fz = ease(q.z - static_cast<double>(c.z));
    const std::uint64_t key = key_of(c);
    const auto row = [&](std::uint64_t k) { return lerp(value_of(k), value_of(k + key_x), fx); };
    return lerp(lerp(row(key), row(key + key_y), fy),
                lerp(row(key + key_z), row(key + key_y + key_z), fy), fz);
}

// Bricks of 2 x 1 x 2 cells, with every second row shifted by half a brick. Mortar is 0; each brick
// has its own value in 0.5..1.
double bricks(const glm::dvec3& q) {
    constexpr double mortar = 0.09;
    const std::int64_t row = cell_of(q.y);
    const double shift = (row & 1) != 0 ? 0.5 : 0.0;
    const glm::dvec3 b{q.x * 0.5 + shift, q.y, q.z * 0.5 + shift};
    const Cell c = cell_of(b);
    const bool in_mortar = b.x - static_cast<double>(c.x) < mortar * 0.5 ||
                           b.y - static_cast<double>(c.y) < mortar ||
                           b.z - static_cast<double>(c.z) < mortar * 0.5;
    return in_mortar ? 0.0 : 0.5 + 0.5 * cell_value(c);
}

double checker(const glm::dvec3& q) {
    const Cell c = cell_of(q);
    return ((c.x ^ c.y ^ c.z) & 1) != 0 ? 1.0 : 0.0;
}

} // namespace

double value_noise(const glm::dvec3& q) {
    return (one_octave(q) * 2.0 + one_octave(q * 2.17)) / 3.0;
}

double pattern_weight(Pattern pattern, const glm::dvec3& q) {
    switch (pattern) {
    case Pattern::flat:
        return 0.0;
    case Pattern::checker:
        return checker(q);
    case Pattern::stripes: // diagonal, so that they show on every face of a box
        return (cell_of(q.x + q.y + q.z) & 1) != 0 ? 1.0 : 0.0;
    case Pattern::noise:
        return value_noise(q);
    case Pattern::bricks:
        return bricks(q);
    case Pattern::tiles:
        return cell_value(cell_of(q));
    }
    return 0.0;
}

} // namespace tessera::corpus
