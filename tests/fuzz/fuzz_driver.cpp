// Runs a fuzz target without libFuzzer:
//   fuzz_corpora TARGET                    runs a fixed corpus of random bytes and damaged seeds
//   fuzz_corpora TARGET --corpus DIR       the same, and the files of a folder, if it exists
//   fuzz_corpora TARGET --write-seeds DIR  writes the seeds
//   fuzz_corpora TARGET FILE...            runs these files, such as a crash that libFuzzer stored
#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

namespace {

using tessera::fuzz::Bytes;
using tessera::fuzz::Target;

void run(const Target& target, const Bytes& input) {
    target.run(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

void run_corpus(const Target& target) {
    std::mt19937 random(2024);
    const std::vector<Bytes> seeds = target.seeds();
    for (const Bytes& seed : seeds)
        run(target, seed);
    for (int round = 0; round < target.rounds; ++round) {
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
            if (target.alter != nullptr && round % 8 == 1)
                target.alter(input, static_cast<unsigned>(random()));
        }
        run(target, input);
        if (target.mend != nullptr) {
            target.mend(input);
            run(target, input);
        }
    }
}

void run_file(const Target& target, const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    run(target, tessera::fuzz::bytes_of(std::string((std::istreambuf_iterator<char>(file)), {})));
}

} // namespace

int main(int argc, char** argv) {
    const auto& targets = tessera::fuzz::targets();
    const auto target =
        std::ranges::find(targets, std::string_view(argc > 1 ? argv[1] : ""), &Target::name);
    if (target == targets.end()) {
        std::fprintf(stderr, "usage: fuzz_corpora TARGET, one of\n");
        for (const Target& one : targets)
            std::fprintf(stderr, "  %s\n", std::string(one.name).c_str());
        return 2;
    }
    const std::string option = argc == 4 ? argv[2] : "";
    if (option == "--write-seeds") {
        tessera::fuzz::write_seeds(*target, argv[3]);
        return 0;
    }
    if (argc == 2 || option == "--corpus")
        run_corpus(*target);
    if (option == "--corpus") {
        std::error_code none;
        for (const auto& entry : std::filesystem::directory_iterator(argv[3], none))
            run_file(*target, entry.path().string());
        return 0;
    }
    for (int i = 2; i < argc; ++i)
        run_file(*target, argv[i]);
    return 0;
}
