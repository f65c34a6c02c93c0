// What libFuzzer asks of a target besides its function: a mutator that mends checksums, and
//   fuzz_x --write-seeds DIR
#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstring>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
    constexpr unsigned left_damaged = 8; // one in so many
    size = LLVMFuzzerMutate(data, size, most);
    if (tessera::fuzz::mend == nullptr || seed % left_damaged == 0)
        return size;
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    tessera::fuzz::Bytes input(bytes, bytes + size);
    tessera::fuzz::mend(input);
    size = std::min(input.size(), most);
    std::memcpy(data, input.data(), size);
    return size;
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    if (*argc == 3 && std::strcmp((*argv)[1], "--write-seeds") == 0) {
        tessera::fuzz::write_seeds((*argv)[2]);
        std::exit(0);
    }
    return 0;
}
