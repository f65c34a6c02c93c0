// A random number generator for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace tessera::test {

using Bytes = std::vector<std::byte>;

// Gives the same numbers on every platform, which the standard distributions do not.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_()); }
    // Both ends are included.
    int range(int first, int last) {
        const auto span = static_cast<std::int64_t>(last) - first + 1;
        return static_cast<int>(first + static_cast<std::int64_t>((*this)() % span));
    }
    double unit() { return (*this)() / 4294967296.0; }
    bool chance(double p) { return unit() < p; }
    Bytes bytes(std::size_t count) {
        Bytes result(count);
        for (std::byte& b : result)
            b = static_cast<std::byte>((*this)() & 255);
        return result;
    }

private:
    std::mt19937 engine_;
};

} // namespace tessera::test
