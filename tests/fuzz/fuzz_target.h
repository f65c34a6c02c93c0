// A fuzz target is one file that registers itself. With fuzz_mutator.cpp and libFuzzer it is a fuzzer; all of
// them and fuzz_driver.cpp are the program of tests on a fixed pseudo-random corpus.
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
    std::string_view name; // of its file
    // Valid inputs, which the driver damages and --write-seeds stores for libFuzzer.
    std::vector<Bytes> (*seeds)();
    void (*run)(const std::uint8_t* data, std::size_t size);
    // Makes all checksums of a damaged input right again, so that what lies behind them is met, too. nullptr: inputs
    // have no checksums.
    void (*mend)(Bytes& input) = nullptr;
    // Changes what damage to single bytes hits too rarely, by the bits of `random`. nullptr: there is nothing of
    // that kind.
    void (*alter)(Bytes& input, unsigned random) = nullptr;
    int rounds = 4000; // of the driver; fewer where libraries and files make them slow
};

// Those of the program.
inline std::vector<Target>& targets() {
    static std::vector<Target> all;
    return all;
}

struct Registered {
    explicit Registered(const Target& target) { targets().push_back(target); }
};

// Stores the seeds in a folder.
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

// Ends the process, so that both libFuzzer and ctest notice.
inline void require(bool condition, const char* what) {
    if (condition)
        return;
    std::fprintf(stderr, "fuzz target: %s\n", what);
    std::abort();
}

} // namespace tessera::fuzz
