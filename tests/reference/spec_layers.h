// Layers, written from FORMAT.md 1.7 and 5.6 alone.
#pragma once

#include "tests/reference/spec_mesh_sampling.h"
#include "tests/reference/spec_notation.h"

#include <map>
#include <string>
#include <vector>

namespace tessera_reference {

struct Light {
    Vector direction; // unit length
    double spread;
    Vector irradiance;
};

struct LayerValues {
    Vector D{}, E{}, G{}, R{};
    double r = 1;
    bool has_specular = false, has_normal = false, has_environment = false;
    Vector X{};              // of the environment
    double a = 0, b = 0;     // samples of the layer of normals
    std::vector<double> x{}; // samples of the visibility, one for each light; empty: no layer
    std::vector<Light> lights{};
};

// The bumped normal, bent towards d.
Vector normal_of(const LayerValues& values, const Frame& frame, const Vector& d);
// The linear light that leaves towards d.
Vector light_of(const LayerValues& values, const Frame& frame, const Vector& d);
// What an observer sees of a place with an opacity, and of the light B behind it.
Vector seen_of(const Vector& L, double opacity, const Vector& B);
// What a sample of the layers 9 and 10 stands for, without the scale.
double difference_of(double sample);

namespace spec {

struct LayerTable {
    struct Further {
        int role;
        float scale;
        uint64_t first_bytes, data_bytes;
        uint64_t first_offset, data_offset; // from the start of the file
    };
    float scale = 1;
    std::vector<Further> further;
    std::vector<Light> lights;
    uint64_t data_offset = 0, data_bytes = 0; // of the first layer
};

// `index_end` is where INDX of the first layer ends.
LayerTable read_layers(Bytes section, uint64_t index_end, uint64_t file_size);

// The file of one texture that a further layer was cut from.
std::vector<std::byte> layer_file(Bytes file, const LayerTable::Further& layer);

} // namespace spec
} // namespace tessera_reference
