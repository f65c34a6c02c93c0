// Runs a fuzz target without libFuzzer:
//   fuzz_x_corpus                    a fixed pseudo-random corpus: random bytes and damaged seeds
//   fuzz_x_corpus --write-seeds DIR  writes the seeds
//   fuzz_x_corpus FILE...            those inputs, for instance a crash that libFuzzer stored
#include "tests/fuzz/fuzz_target.h"

#include <fstream>
#include <iterator>
#include <random>
#include <string>

namespace {

using tessera::fuzz::Bytes;

void run(const Bytes& input) {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

void run_corpus(int rounds) {
    std::mt19937 random(2024);
    const std::vector<Bytes> seeds = tessera::fuzz::seeds();
    for (const Bytes& seed : seeds)
        run(seed);
    for (int round = 0; round < rounds; ++round) {
        Bytes input;
        if (round % 4 == 0) {
            input.resize(random() % 300);
            for (std::byte& b : input)
                b = static_cast<std::byte>(random() & 255);
        } else {
            input = seeds[random() % seeds.size()];
            if (random() % 4 == 0)
                input.resize(random() % (input.size() + 1));
            for (unsigned n = random() % 6; n > 0 && !input.empty(); --n)
                input[random() % input.size()] ^=
                    static_cast<std::byte>(random() % 2 ? 1u << random() % 8 : random() & 255);
        }
        run(input);
    }
}

} // namespace

int main(int argc, char** argv) {
    if (argc == 3 && std::string(argv[1]) == "--write-seeds") {
        int number = 0;
        for (const Bytes& seed : tessera::fuzz::seeds())
            std::ofstream(std::string(argv[2]) + "/seed" + std::to_string(number++),
                          std::ios::binary)
                .write(reinterpret_cast<const char*>(seed.data()),
                       static_cast<std::streamsize>(seed.size()));
        return 0;
    }
    for (int i = 1; i < argc; ++i) {
        std::ifstream file(argv[i], std::ios::binary);
        const std::string text((std::istreambuf_iterator<char>(file)), {});
        const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
        run(Bytes(bytes, bytes + text.size()));
    }
    if (argc == 1)
        run_corpus(4000);
    return 0;
}
