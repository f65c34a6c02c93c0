// Runs a fuzz target without libFuzzer:
//   fuzz_corpora TARGET                    runs a fixed corpus of random bytes and damaged seeds
//   fuzz_corpora TARGET --corpus DIR       the same, and the files of a folder, if it exists
//   fuzz_corpora TARGET --write-seeds DIR  writes the seeds
//   fuzz_corpora TARGET --damage COUNT     runs COUNT damaged variants of every seed, none longer than
//                                          10 s; stores a variant that fails in fuzz_damaged.bin
//   fuzz_corpora TARGET FILE...            runs these files, such as a crash that libFuzzer stored
#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <unistd.h>

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

// The input that runs now, for the handler of signals.
const Bytes* running = nullptr;
constexpr unsigned most_seconds = 10;

extern "C" void store_running(int signal) {
    const int file = ::open("fuzz_damaged.bin", O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const bool is_stored = file >= 0 && ::write(file, running->data(), running->size()) ==
                                            static_cast<ssize_t>(running->size());
    constexpr char said[] = "the input is in fuzz_damaged.bin\n";
    (void)!::write(2, said, is_stored ? sizeof said - 1 : 0);
    std::signal(signal, SIG_DFL);
    (void)::raise(signal);
}

// One of: bits and bytes changed, cut short, a piece repeated, removed or overwritten with zeros or
// ones.
Bytes damaged(const Bytes& seed, std::mt19937& random) {
    Bytes input = seed;
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    const std::size_t at = below(input.size() + 1);
    const std::size_t length = below(std::min<std::size_t>(64, input.size() - at) + 1);
    const auto begin = input.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    switch (random() % 8) {
    case 0:
        input.resize(at);
        break;
    case 1: {
        const Bytes piece(begin, end);
        input.insert(begin, piece.begin(), piece.end());
        break;
    }
    case 2:
        input.erase(begin, end);
        break;
    case 3:
        std::fill(begin, end, random() % 2 ? std::byte{0} : std::byte{255});
        break;
    default:
        for (std::size_t n = 1 + below(6); n > 0 && !input.empty(); --n)
            input[below(input.size())] ^=
                static_cast<std::byte>(random() % 2 ? 1u << random() % 8 : random() & 255);
    }
    return input;
}

void run_damaged(const Target& target, int count) {
    for (const int signal : {SIGALRM, SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL})
        std::signal(signal, store_running);
    std::mt19937 random(58);
    double slowest = 0;
    std::uint64_t variants = 0;
    const std::vector<Bytes> seeds = target.seeds();
    const auto timed = [&](const Bytes& input) {
        running = &input;
        const auto start = std::chrono::steady_clock::now();
        ::alarm(most_seconds);
        run(target, input);
        ::alarm(0);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        slowest = std::max(slowest, seconds.count());
        ++variants;
    };
    for (const Bytes& seed : seeds)
        for (int i = 0; i < count; ++i) {
            Bytes input = damaged(seed, random);
            timed(input);
            if (target.mend != nullptr && i % 2 == 0) {
                target.mend(input);
                timed(input);
            }
        }
    std::printf("%s: %zu seeds, %llu damaged variants, the slowest took %.3f s\n",
                std::string(target.name).c_str(), seeds.size(),
                static_cast<unsigned long long>(variants), slowest);
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
    if (option == "--damage") {
        run_damaged(*target, std::atoi(argv[3]));
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
