#include "tests/reference/spec_layers.h"

#include <algorithm>
#include <cmath>

namespace tessera_reference {
namespace {

double scalar_product(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector sum(const Vector& a, double k, const Vector& b) {
    return {a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]};
}

Vector vector_product(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector of_unit_length(const Vector& a) {
    const double length = std::sqrt(scalar_product(a, a));
    return {a[0] / length, a[1] / length, a[2] / length};
}

// The factor of the light in one channel with reflectance G (B of the table in 5.6).
double share(double c, double q, double G) {
    static const double k[2][4][4] = {{{0.005, 4.342, -6.276, 2.906},
                                       {1.07, -7.577, 16.225, -9.22},
                                       {1.467, -4.067, -5.616, 6.752},
                                       {-1.745, 6.274, -3.532, -0.735}},
                                      {{1.048, -4.432, 6.109, -2.742},
                                       {-2.27, 12.147, -19.452, 9.669},
                                       {1.162, -10.616, 20.845, -11.548},
                                       {0.126, 2.675, -7.248, 4.528}}};
    double b[2] = {0, 0};
    for (int n = 0; n < 2; ++n) {
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i)
                b[n] += k[n][j][i] * std::pow(c, i) * std::pow(q, j);
        b[n] = std::clamp(b[n], 0.0, 1.0);
    }
    return G * b[0] + b[1];
}

} // namespace

Vector normal_of(const LayerValues& values, const Frame& frame, const Vector& d) {
    Vector n = frame.ez;
    if (values.has_normal) {
        double x = (255 * values.a - 128) / 127, y = (255 * values.b - 128) / 127;
        const double root = std::sqrt(x * x + y * y);
        if (root > 1) {
            x /= root;
            y /= root;
        }
        const double z = std::sqrt(std::max(0.0, 1 - x * x - y * y));
        n = of_unit_length(sum(sum(sum({0, 0, 0}, x, frame.ex), y, frame.ey), z, frame.ez));
    }
    const double c = scalar_product(n, d);
    return c < 0.02 ? of_unit_length(sum(n, 0.02 - c, d)) : n;
}

Vector light_of(const LayerValues& values, const Frame& frame, const Vector& d) {
    const Vector n = normal_of(values, frame, d);
    Vector light = values.E;
    if (!values.has_specular) {
        for (std::size_t i = 0; i < 3; ++i)
            light[i] += values.D[i] + values.R[i];
        return light;
    }
    const double c = std::clamp(scalar_product(n, d), 0.0, 1.0);
    const double q = std::max(values.r, 0.03), a = q * q;
    double m = 0;
    for (const Light& l : values.lights)
        m = std::max({m, l.irradiance[0], l.irradiance[1], l.irradiance[2]});
    for (std::size_t i = 0; i < 3; ++i)
        light[i] += values.D[i] + share(c, q, values.G[i]) * values.R[i];
    const double w = std::clamp((values.r - 0.1) / 0.3, 0.0, 1.0);
    Vector seen{}, whole{}; // of the lights that the environment stands for
    for (std::size_t j = 0; j < values.lights.size(); ++j) {
        const Light& l = values.lights[j];
        const double z = scalar_product(n, l.direction), nd = scalar_product(n, d);
        const double k = std::clamp(10 * values.r - 1.5, 0.0, 1.0), p = k * l.spread;
        const double H = std::clamp(0.6 + z / std::max(3 * p, 1e-6), 0.0, 1.0);
        if (H == 0 || nd <= 0)
            continue;
        const double raised = (z + std::sqrt(z * z + 4 * p * p)) / 2;
        const Vector toward = of_unit_length(sum(l.direction, raised - z, n));
        const double nl = scalar_product(n, toward);
        double V = 1;
        if (!values.x.empty()) {
            const double mj = std::max({l.irradiance[0], l.irradiance[1], l.irradiance[2]});
            const double peak = m > 0 ? std::max(1.0 / 51, std::sqrt(mj / m)) : 1;
            V = std::min(1.0, values.x[j] / peak);
        }
        const Vector h = of_unit_length(sum(toward, 1, d));
        const double nh = std::min(1.0, scalar_product(n, h));
        const double wide = 0.75 * l.spread;
        const double e = std::max(0.01, 1 - k * (1 - scalar_product(d, h)));
        const double A1 = std::min(1.0, a * a + wide * wide);
        const double A2 = std::min(1.0, a * a + std::pow(wide / e, 2));
        const Vector o = vector_product(toward, d);
        const double x = std::pow(scalar_product(n, o), 2) / std::max(1e-12, scalar_product(o, o));
        const double y = std::max(0.0, 1 - nh * nh - x);
        const double pi = 3.14159265358979323846;
        const double Q = 1 / (pi * std::sqrt(A1 * A2) * std::pow(nh * nh + x / A2 + y / A1, 2));
        const double W = 1 / (2 * nl * std::sqrt(a * a + (1 - a * a) * c * c) +
                              2 * c * std::sqrt(a * a + (1 - a * a) * nl * nl));
        for (std::size_t i = 0; i < 3; ++i) {
            const double F = values.G[i] + (1 - values.G[i]) *
                                               std::pow(1 - std::max(0.0, scalar_product(d, h)), 5);
            const double S = H * F * Q * W * nl * l.irradiance[i];
            const bool replaced = values.has_environment && l.spread > 0;
            seen[i] += replaced ? V * S : 0;
            whole[i] += replaced ? S : 0;
            light[i] += (replaced ? w : 1) * V * S;
        }
    }
    if (values.has_environment)
        for (std::size_t i = 0; i < 3; ++i)
            light[i] += (1 - w) * (1e-6 + seen[i]) / (1e-6 + whole[i]) * share(c, q, values.G[i]) *
                        values.X[i];
    return light;
}

Vector seen_of(const Vector& L, double opacity, const Vector& B) {
    const double o = opacity >= 254.0 / 255 ? 1 : opacity;
    Vector seen{};
    for (std::size_t i = 0; i < 3; ++i)
        seen[i] = std::min(1.0, o * L[i] + (1 - o) * B[i]);
    return seen;
}

double difference_of(double sample) {
    return std::max(-1.0, std::min(1.0, (255 * sample - 128) / 127));
}

namespace spec {
namespace {

double half(uint16_t bits) {
    const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
    const double magnitude = exponent == 31  ? (mantissa ? NAN : INFINITY)
                             : exponent == 0 ? std::ldexp(mantissa, -24)
                                             : std::ldexp(1024 + mantissa, exponent - 25);
    return bits >> 15 ? -magnitude : magnitude;
}

Light read_light(Bytes bytes) {
    Light light{};
    for (size_t i = 0; i < 3; ++i) {
        light.direction[i] = static_cast<int16_t>(u16(bytes, 2 * i));
        light.irradiance[i] = half(u16(bytes, 8 + 2 * i));
        require(std::isfinite(light.irradiance[i]) && light.irradiance[i] >= 0, "LAYR: irradiance");
    }
    light.spread = half(u16(bytes, 6));
    require(light.spread >= 0 && light.spread <= 3.14159265358979323846, "LAYR: spread");
    require(scalar_product(light.direction, light.direction) > 0, "LAYR: direction");
    light.direction = of_unit_length(light.direction);
    return light;
}

} // namespace

LayerTable read_layers(Bytes section, uint64_t index_end, uint64_t file_size) {
    LayerTable table;
    const size_t count = u8(section, 0), lights = u16(section, 2);
    require(count >= 1 && count <= 31, "LAYR: number of further layers");
    require(u8(section, 1) == 0, "LAYR: byte 1");
    require(lights <= 1024, "LAYR: number of lights");
    const auto is_scale = [](float x) { return std::isfinite(x) && x > 0; };
    table.scale = f32(section, 4);
    require(is_scale(table.scale), "LAYR: scale");
    require(section.size() == 8 + 20 * count + 14 * lights, "LAYR: length");
    uint64_t firsts = 0, datas = 0;
    std::vector<bool> has(12, false);
    has[0] = true;
    for (size_t i = 0; i < count; ++i) {
        const Bytes entry = section.subspan(8 + 20 * i, 20);
        const LayerTable::Further layer{
            u8(entry, 0), f32(entry, 4), u32(entry, 8), u64(entry, 12), 0, 0};
        if (layer.role > 11)
            throw Refusal{"LAYR: unknown role"};
        require(u8(entry, 1) == 0 && u8(entry, 2) == 0 && u8(entry, 3) == 0, "LAYR: bytes 1..3");
        require(is_scale(layer.scale), "LAYR: scale");
        require(!has[static_cast<size_t>(layer.role)], "LAYR: a role occurs twice");
        has[static_cast<size_t>(layer.role)] = true;
        require(layer.data_bytes <= file_size && layer.first_bytes <= file_size, "LAYR: bytes");
        firsts += layer.first_bytes;
        datas += layer.data_bytes;
        require(datas <= file_size && firsts <= file_size, "LAYR: bytes");
        table.further.push_back(layer);
    }
    require(has[2] || (!has[3] && !has[4] && !has[5] && !has[8] && lights == 0),
            "LAYR: role 2 is missing");
    require(lights > 0 || (!has[5] && !has[8]), "LAYR: roles 5 and 8 need lights");
    for (size_t i = 0; i < lights; ++i)
        table.lights.push_back(read_light(section.subspan(8 + 20 * count + 14 * i, 14)));
    require(index_end <= file_size && firsts + datas <= file_size - index_end,
            "LAYR: the layers do not fit the file");
    table.data_offset = index_end + firsts;
    table.data_bytes = file_size - table.data_offset - datas;
    uint64_t first = index_end, data = table.data_offset + table.data_bytes;
    for (LayerTable::Further& layer : table.further) {
        layer.first_offset = first;
        layer.data_offset = data;
        first += layer.first_bytes;
        data += layer.data_bytes;
    }
    return table;
}

std::vector<std::byte> layer_file(Bytes file, const LayerTable::Further& layer) {
    const Bytes first = file.subspan(layer.first_offset, layer.first_bytes);
    const Bytes data = file.subspan(layer.data_offset, layer.data_bytes);
    std::vector<std::byte> out(first.begin(), first.end());
    out.insert(out.end(), data.begin(), data.end());
    return out;
}

} // namespace spec
} // namespace tessera_reference
