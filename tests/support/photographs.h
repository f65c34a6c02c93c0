// Small sets of posed photographs on disk.
#pragma once

#include "corpus/photographs/photograph.h"
#include "tests/support/test_folder.h"

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace tessera::test {

// A picture of one colour, as PPM, which the readers detect whatever the name is.
inline std::string plain_ppm(unsigned width, unsigned height, const std::string& rgb) {
    std::string file = "P6\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n";
    for (unsigned i = 0; i < width * height; ++i)
        file += rgb;
    return file;
}

// A camera at `eye` that looks along -z, with y upwards.
inline std::string matrix_at(const std::string& x, const std::string& y, const std::string& z) {
    return "[[1,0,0," + x + "],[0,1,0," + y + "],[0,0,1," + z + "],[0,0,0,1]]";
}

// A camera that looks at `centre` from `distance`, turned by `angle` about the axis y and lifted.
inline std::string matrix_around(const std::array<double, 3>& centre, double distance, double angle,
                                 double lift) {
    const std::array back{std::cos(lift) * std::sin(angle), std::sin(lift),
                          std::cos(lift) * std::cos(angle)};
    const double n = std::hypot(back[0], back[2]);
    const std::array right{back[2] / n, 0.0, -back[0] / n};
    const std::array up{back[1] * right[2] - back[2] * right[1],
                        back[2] * right[0] - back[0] * right[2],
                        back[0] * right[1] - back[1] * right[0]};
    std::string text = "[";
    for (std::size_t i = 0; i < 3; ++i)
        text += "[" + std::to_string(right[i]) + "," + std::to_string(up[i]) + "," +
                std::to_string(back[i]) + "," + std::to_string(centre[i] + distance * back[i]) +
                "],";
    return text + "[0,0,0,1]]";
}

inline std::string frame_json(const std::string& name, const std::string& matrix,
                              const std::string& more = "") {
    return R"({"file_path":")" + name + R"(","transform_matrix":)" + matrix + more + "}";
}

inline std::string transforms_json(const std::string& head,
                                   const std::vector<std::string>& frames) {
    std::string text = "{" + head + R"("frames":[)";
    for (std::size_t i = 0; i < frames.size(); ++i)
        text += (i > 0 ? "," : "") + frames[i];
    return text + "]}";
}

// Little-endian bytes of numbers, as COLMAP writes them. Precondition: a little-endian machine.
template <class Number> void append_number(std::string& file, Number number) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    file.append(bytes, sizeof number);
}

} // namespace tessera::test
