// A fuzz target is one file with these two functions. With libFuzzer it is a fuzzer; with
// fuzz_driver.cpp it is a test on a fixed pseudo-random corpus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace tessera::fuzz {

using Bytes = std::vector<std::byte>;

// Valid inputs, which the driver damages and --write-seeds stores for libFuzzer.
std::vector<Bytes> seeds();

// Ends the process, so that both libFuzzer and ctest notice.
inline void require(bool condition, const char* what) {
    if (condition)
        return;
    std::fprintf(stderr, "fuzz target: %s\n", what);
    std::abort();
}

} // namespace tessera::fuzz
