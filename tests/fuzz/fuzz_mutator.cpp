// The functions that libFuzzer calls in a program with one target. The mutator corrects checksums.
//   fuzz_x --write-seeds DIR   writes the seeds
#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstring>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    tessera::fuzz::targets().front().run(data, size);
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
    using namespace tessera::fuzz;
    constexpr unsigned left_damaged = 8, altered = 16; // one in so many inputs
    const Target& target = targets().front();
    const bool alters = target.alter != nullptr && seed % altered == 1;
    if (!alters)
        size = LLVMFuzzerMutate(data, size, most);
    if (target.mend == nullptr || seed % left_damaged == 0)
        return size;
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    Bytes input(bytes, bytes + size);
    if (alters)
        target.alter(input, seed / altered);
    target.mend(input);
    size = std::min(input.size(), most);
    std::memcpy(data, input.data(), size);
    return size;
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    if (*argc == 3 && std::strcmp((*argv)[1], "--write-seeds") == 0) {
        tessera::fuzz::write_seeds(tessera::fuzz::targets().front(), (*argv)[2]);
        std::exit(0);
    }
    return 0;
}
