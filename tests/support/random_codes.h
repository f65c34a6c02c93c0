// Random parameters and samples for the tests of tiles.
#pragma once

#include "codec/entropy/tile_syntax.h"
#include "format/samples.h"
#include "format/texture.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

namespace tessera::test::random_codes {

inline CodingParameters parameters_with(Random& random, bool rotation) {
    CodingParameters parameters;
    for (StepCode& step : parameters.step)
        step = StepCode::nearest(1 + 20 * random.unit());
    parameters.rotated_step = parameters.step[0];
    parameters.colour_rotation = rotation;
    parameters.dependent = random.chance(0.5);
    parameters.parameters = random.chance(0.3) ? random_parameters(random) : default_parameters();
    return parameters;
}

inline Bytes random_samples(Random& random, std::size_t count, SampleType type) {
    Bytes bytes;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint16_t sample =
            type == SampleType::unorm8
                ? static_cast<std::uint16_t>(random.range(0, 255))
                : static_cast<std::uint16_t>(random.range(0, 0x7BFF) |
                                             (random.chance(0.5) ? 0x8000 : 0));
        bytes.push_back(static_cast<std::byte>(sample & 255));
        if (type == SampleType::half16)
            bytes.push_back(static_cast<std::byte>(sample >> 8));
    }
    return bytes;
}

inline std::int32_t code_at(const Bytes& texels, std::size_t i, SampleType type) {
    if (type == SampleType::unorm8)
        return std::to_integer<std::int32_t>(texels[i]);
    return sample_code(
        static_cast<std::uint16_t>(std::to_integer<unsigned>(texels[2 * i]) |
                                   std::to_integer<unsigned>(texels[2 * i + 1]) << 8),
        type);
}

} // namespace tessera::test::random_codes
