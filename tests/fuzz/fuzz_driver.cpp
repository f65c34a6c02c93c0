// Runs a fuzz target without libFuzzer:
//   fuzz_x_corpus                    a fixed pseudo-random corpus: random bytes and damaged seeds
//   fuzz_x_corpus --corpus DIR       that, and the inputs in a folder, if there is one
//   fuzz_x_corpus --write-seeds DIR  writes the seeds
//   fuzz_x_corpus FILE...            those inputs, for instance a crash that libFuzzer stored
#include "tests/fuzz/fuzz_target.h"

#include <filesystem>
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
            if (tessera::fuzz::is_there(tessera::fuzz::alter) && round % 8 == 1)
                tessera::fuzz::alter(input, static_cast<unsigned>(random()));
        }
        run(input);
        if (tessera::fuzz::is_there(tessera::fuzz::mend)) {
            tessera::fuzz::mend(input);
            run(input);
        }
    }
}

void run_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    run(tessera::fuzz::bytes_of(std::string((std::istreambuf_iterator<char>(file)), {})));
}

} // namespace

int main(int argc, char** argv) {
    const std::string option = argc == 3 ? argv[1] : "";
    if (option == "--write-seeds") {
        tessera::fuzz::write_seeds(argv[2]);
        return 0;
    }
    if (argc == 1 || option == "--corpus")
        run_corpus(TESSERA_FUZZ_ROUNDS);
    if (option == "--corpus") {
        std::error_code none;
        for (const auto& entry : std::filesystem::directory_iterator(argv[2], none))
            run_file(entry.path().string());
        return 0;
    }
    for (int i = 1; i < argc; ++i)
        run_file(argv[i]);
    return 0;
}
