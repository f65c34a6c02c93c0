// A fuzz target is a file that registers itself. With fuzz_mutator.cpp and libFuzzer it is a
// fuzzer. All targets together with fuzz_driver.cpp are a test program that runs a fixed
// pseudo-random corpus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::fuzz {

using Bytes = std::vector<std::byte>;

struct Target {
    std::string_view name; // the name of its file
    // Valid inputs, which the driver damages and --write-seeds stores for libFuzzer.
    std::vector<Bytes> (*seeds)();
    void (*run)(const std::uint8_t* data, std::size_t size);
    // Corrects the checksums of a damaged input, so that the data that they protect are tested,
    // too. nullptr if inputs have no checksums.
    void (*mend)(Bytes& input) = nullptr;
    // Makes changes, chosen by the bits of `random`, that damage to single bytes makes too rarely.
    // nullptr if none are needed.
    void (*alter)(Bytes& input, unsigned random) = nullptr;
    int rounds = 4000; // of the driver; fewer for slow targets
};

// The targets of the program.
inline std::vector<Target>& targets() {
    static std::vector<Target> all;
    return all;
}

struct Registered {
    explicit Registered(const Target& target) { targets().push_back(target); }
};

// Writes the seeds to a folder.
inline void write_seeds(const Target& target, const std::string& folder) {
    int number = 0;
    for (const Bytes& seed : target.seeds())
        std::ofstream(folder + "/seed" + std::to_string(number++), std::ios::binary)
            .write(reinterpret_cast<const char*>(seed.data()),
                   static_cast<std::streamsize>(seed.size()));
}

inline Bytes bytes_of(std::string_view text) {
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    return {bytes, bytes + text.size()};
}

// Aborts on failure, which both libFuzzer and ctest report.
inline void require(bool condition, const char* what) {
    if (condition)
        return;
    std::fprintf(stderr, "fuzz target: %s\n", what);
    std::abort();
}

} // namespace tessera::fuzz
