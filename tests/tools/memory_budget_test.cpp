// Tests that the size of slabs changes no byte and that memory budgets are kept.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/texels/sample_tiles.h"
#include "corpus/bake.h"
#include "tests/support/test_folder.h"
#include "tools/support/memory_budget.h"
#include "tools/support/option_checks.h"
#include "tools/texture_io/texture_io.h"

#include <fstream>
#include <map>
#include <set>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr Extent4 held_size{40, 36, 10, 9};

std::map<std::string, std::string> files_of(const fs::path& path) {
    std::map<std::string, std::string> files;
    const auto add = [&](const fs::path& file) {
        files[file.filename().string()] = test::slurp(file);
    };
    if (!fs::is_directory(path))
        add(path);
    else
        for (const auto& entry : fs::directory_iterator(path))
            add(entry.path());
    return files;
}

class Memory : public testing::Test {
protected:
    static void SetUpTestSuite() {
        auto baked = corpus::make_baked_source("composed", held_size, 1, 1);
        ASSERT_TRUE(baked.ok());
        EncodeOptions options;
        options.effort = 0;
        options.tile_extent = {16, 16, 8, 8};
        ASSERT_TRUE(encode_memory(**baked, coded_, options));
    }
    void SetUp() override {
        folder_ = test::make_test_folder("memory");
        file_ = wrap_memory(coded_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    Status decode(const std::string& name, const Box4& box, std::uint64_t slab_bytes) const {
        const auto decoder = Decoder::open(*file_);
        TESSERA_TRY(decoder.status());
        TextureDesc desc = decoder->desc();
        auto sink = create_texture((folder_ / name).string(), desc, {}, 2);
        TESSERA_TRY(sink.status());
        return decoder->decode(box, **sink, 2, {}, slab_bytes);
    }

    fs::path folder_;
    static inline std::vector<std::byte> coded_;
    std::unique_ptr<ByteSource> file_;
};

struct Kind {
    const char* name;
    std::uint64_t least; // bytes of the smallest possible slab
};
const Kind kinds[] = {{"x.rgb", 3 * 10 * 9}, {"x.exr", 3 * 40 * 10 * 9}, {"x_views/", 3 * 40 * 36}};

TEST_F(Memory, CutsOfSlabsDoNotChangeWhatIsDecoded) {
    for (const Kind& kind : kinds) {
        const fs::path path = folder_ / kind.name;
        ASSERT_TRUE(decode(kind.name, Box4::whole(held_size), 1ull << 40));
        const auto whole = files_of(path);
        for (const std::uint64_t factor : {1u, 2u, 7u, 23u}) {
            fs::remove_all(path);
            const Status status = decode(kind.name, Box4::whole(held_size), kind.least * factor);
            ASSERT_TRUE(status) << status.message();
            EXPECT_TRUE(files_of(path) == whole) << kind.name << " " << factor;
        }
        const Status refused = decode(kind.name, Box4::whole(held_size), kind.least - 1);
        EXPECT_EQ(refused.code(), ErrorCode::over_budget) << kind.name;
        EXPECT_NE(with_memory_hint(refused).message().find("--memory"), std::string::npos);
    }
}

TEST_F(Memory, CutsOfSlabsDoNotChangeWhatIsEncoded) {
    for (const Kind& kind : kinds) {
        ASSERT_TRUE(decode(kind.name, Box4::whole(held_size), 1ull << 40));
        const auto encode = [&](std::uint64_t slab_bytes, std::vector<std::byte>& out) -> Status {
            TextureHints hints;
            hints.size = held_size;
            auto opened = open_texture((folder_ / kind.name).string(), hints);
            TESSERA_TRY(opened.status());
            EncodeOptions options;
            options.effort = 0;
            options.tile_extent = {16, 16, 8, 8};
            options.slab_bytes = slab_bytes;
            options.threads = 2;
            options.labels.source = kind.name;
            return encode_memory(*opened->source, out, options).status();
        };
        std::vector<std::byte> whole, cut;
        ASSERT_TRUE(encode(1ull << 40, whole));
        // Tiles are at most 14 x 12 x 5 x 5.
        for (const std::uint64_t tiles : {1u, 9u}) {
            const Status status = encode(tiles * 3 * 14 * 12 * 5 * 5, cut);
            ASSERT_TRUE(status) << kind.name << status.message();
            EXPECT_TRUE(cut == whole) << kind.name << " " << tiles;
        }
        const bool holds_slabs = std::string(kind.name) != "x.rgb";
        const Status refused = encode(1000, cut);
        EXPECT_EQ(refused.code(), holds_slabs ? ErrorCode::over_budget : ErrorCode::ok);
        EXPECT_EQ(refused.message().starts_with(kind.name), holds_slabs) << refused.message();
    }
}

TEST(MemoryBudget, ReadsSizes) {
    const std::pair<const char*, std::uint64_t> good[] = {
        {"0", 0},      {"12345", 12345},    {"1.5G", 3ull << 29}, {"0.1k", 102},
        {"7b", 7},     {"512M", 512 << 20}, {"1GiB", 1ull << 30}, {"3t", 3ull << 40},
        {"2kb", 2048}, {"1Gib", 1ull << 30}};
    for (const auto& [text, bytes] : good) {
        const auto parsed = parse_size(text);
        ASSERT_TRUE(parsed) << text;
        EXPECT_EQ(*parsed, bytes) << text;
    }
    for (const char* text : {"", "M", "1.5", "1.G", "1.5.5G", "-1", "1X", "1GG", " 1G", "1 G",
                             "18446744073709551616", "9999999999T", "8388608T"})
        EXPECT_EQ(parse_size(text).status().code(), ErrorCode::bad_argument) << text;
}

TEST(ChooseNumbers, ASeedDeterminesTheRandomSet) {
    EXPECT_EQ(choose_numbers(5, 9, 1), (std::vector<std::uint64_t>{0, 1, 2, 3, 4}));
    EXPECT_TRUE(choose_numbers(0, 3, 1).empty());
    std::vector<int> times(50);
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        const auto numbers = choose_numbers(50, 5, seed);
        EXPECT_EQ(std::set<std::uint64_t>(numbers.begin(), numbers.end()).size(), 5u);
        EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
        EXPECT_EQ(numbers, choose_numbers(50, 5, seed));
        for (const std::uint64_t number : numbers)
            ++times[number];
    }
    for (const int n : times) // expected 200, standard deviation 13
        EXPECT_NEAR(n, 200, 65);
    EXPECT_NE(choose_numbers(1u << 20, 4, 1), choose_numbers(1u << 20, 4, 2));
    EXPECT_LT(choose_numbers(1ull << 40, 1000, 7).back(), 1ull << 40);
}

#ifndef TESSERA_SANITIZED // would measure the sanitizer's memory
// Peak memory of the tool's process, in bytes.
std::uint64_t peak_of(const fs::path& folder, std::vector<std::string> words) {
    words.insert(words.begin(), TESSERA_TOOL);
    const pid_t child = fork();
    if (child == 0) {
        std::vector<char*> argv;
        for (std::string& word : words)
            argv.push_back(word.data());
        argv.push_back(nullptr);
        if (chdir(folder.c_str()) == 0)
            execv(TESSERA_TOOL, argv.data());
        _exit(126);
    }
    int status = 0;
    rusage usage = {};
    wait4(child, &status, 0, &usage);
    EXPECT_EQ(status, 0) << testing::PrintToString(words);
    return static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
}

// 100 MB of texels in one row of tiles, which EXR and raw files would otherwise hold at once. Half
// floats, because time depends on the number of texels.
TEST_F(Memory, StaysWithinItsBudget) {
    const std::uint64_t budget = 132ull << 20;
    const std::vector<std::string> common{"-q", "--threads", "2", "--memory", "132M"};
    const auto expect_within = [&](std::vector<std::string> words) {
        words.insert(words.end(), common.begin(), common.end());
        EXPECT_LT(peak_of(folder_, words), budget) << testing::PrintToString(words);
    };
    expect_within({"bake", "lamps", "-o", "a.tess", "--size", "512x32x32x32", "--spp", "1",
                   "--effort", "0", "--quality", "30", "--no-verify"});
    expect_within({"decode", "a.tess", "-o", "a.rgb16f"});
    expect_within({"decode", "a.tess", "-o", "a.exr"});
    expect_within({"encode", "a.exr", "-o", "b.tess", "--effort", "0", "--quality", "30"});
    expect_within({"compare", "a.rgb16f", "a.tess"});
}
#endif

} // namespace
} // namespace tessera
