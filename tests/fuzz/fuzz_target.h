// A fuzz target is one file with these two functions. With libFuzzer it is a fuzzer; with
// fuzz_driver.cpp it is a test on a fixed pseudo-random corpus.
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

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace tessera::fuzz {

using Bytes = std::vector<std::byte>;

// Valid inputs, which the driver damages and --write-seeds stores for libFuzzer.
std::vector<Bytes> seeds();

// Makes all checksums of a damaged input right again, so that what lies behind them is met, too. Without one
// in the target's file, inputs have no checksums.
[[gnu::weak]] void mend(Bytes& input);

// Changes what damage to single bytes hits too rarely, by the bits of `random`. Without one in the target's file,
// there is nothing of that kind.
[[gnu::weak]] void alter(Bytes& input, unsigned random);

// Whether the target's file has one of these two.
template <class Function> bool is_there(Function* function) {
    return function != nullptr;
}

// Stores the seeds in a folder.
inline void write_seeds(const std::string& folder) {
    int number = 0;
    for (const Bytes& seed : seeds())
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
