// Lets every system call that changes a file fail once. The command must report an error, keep the
// old file, and leave nothing behind except an announced journal.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "corpus/bake.h"
#include "format/io/system_calls.h"
#include "format/texture.h"
#include "tests/support/test_folder.h"
#include "tools/support/copy_texture.h"
#include "tools/texture_io/texture_io.h"

#include <atomic>
#include <cerrno>
#include <fstream>
#include <functional>
#include <map>
#include <sys/mount.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;
using sys::Call;

// The hook is a plain function, so its counter is static.
std::atomic<Call> failing_call;
std::atomic<int> calls_left;

int fail_one(Call call) {
    return call == failing_call && --calls_left == 0 ? ENOSPC : 0;
}

// During its lifetime, call number `n` (from 1) of one kind fails.
class Fault {
public:
    Fault(Call call, int n) {
        failing_call = call;
        calls_left = n;
        sys::set_fault_hook(fail_one);
    }
    ~Fault() { sys::set_fault_hook(nullptr); }
    bool happened() const { return calls_left <= 0; }
};

// All files below a folder, with their contents.
std::map<std::string, std::string> contents_of(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        files[fs::relative(entry.path(), folder).string()] =
            entry.is_directory() ? "/" : test::slurp(entry.path());
    return files;
}

constexpr Extent4 written_size{20, 12, 6, 5};

class FailingWrites : public testing::Test {
protected:
    void SetUp() override {
        folder_ = test::make_test_folder("failing");
        auto baked = corpus::make_baked_source("composed", written_size, 1, 1);
        ASSERT_TRUE(baked.ok());
        baked_ = std::move(*baked);
        texels_.resize(baked_->desc().box_bytes(Box4::whole(written_size)));
        ASSERT_TRUE(baked_->read(Box4::whole(written_size), texels_));
    }
    void TearDown() override {
        sys::set_fault_hook(nullptr);
        fs::remove_all(folder_);
    }

    // Runs `work` once for each call of each kind, which fails.
    void fail_everything(const std::string& name, const std::function<Status()>& work) {
        ASSERT_TRUE(work()); // creates the old file
        const auto old = contents_of(folder_);
        int faults = 0;
        for (const Call call : {Call::open, Call::write, Call::truncate, Call::sync, Call::close,
                                Call::rename, Call::make_folder})
            for (int n = 1; n < 10000; ++n) {
                Status status;
                {
                    const Fault fault(call, n);
                    status = work();
                    if (!fault.happened()) {
                        EXPECT_TRUE(status) << status.message();
                        break;
                    }
                }
                ++faults;
                const std::string what = name + ", call " + std::to_string(static_cast<int>(call)) +
                                         " number " + std::to_string(n) + ": " + status.message();
                EXPECT_EQ(status.code(), ErrorCode::io) << what;
                EXPECT_NE(status.message().find(name), std::string::npos) << what;
                EXPECT_NE(status.message().find("No space left"), std::string::npos) << what;
                const bool announced = status.message().find("kept in") != std::string::npos;
                const std::string journal = name + ".journal";
                EXPECT_EQ(fs::exists(folder_ / journal), announced) << what;
                fs::remove_all(folder_ / journal);
                EXPECT_TRUE(contents_of(folder_) == old) << what;
            }
        EXPECT_GT(faults, 3) << name;
    }

    EncodeOptions options() const {
        EncodeOptions o;
        o.tile_extent = {8, 8, 6, 5};
        o.effort = 1;
        o.threads = 2;
        return o;
    }
    std::string at(const std::string& name) const { return (folder_ / name).string(); }

    fs::path folder_;
    std::unique_ptr<TexelSource> baked_;
    std::vector<std::byte> texels_;
};

TEST_F(FailingWrites, Encode) {
    for (const JournalUse journal : {JournalUse::none, JournalUse::start})
        fail_everything("x.tess", [&] {
            MemorySource source(baked_->desc(), texels_);
            EncodeOptions o = options();
            o.journal = journal;
            return encode_file(source, at("x.tess"), o).status();
        });
}

TEST_F(FailingWrites, BakeAndEncodeInSeveralPasses) {
    EncodeOptions o = options();
    o.journal = JournalUse::start;
    o.rate = {RateTarget::Kind::bytes, 3000};
    fail_everything("y.tess", [&] { return encode_file(*baked_, at("y.tess"), o).status(); });
}

TEST_F(FailingWrites, ResumesAfterAFault) {
    EncodeOptions o = options();
    MemorySource source(baked_->desc(), texels_);
    ASSERT_TRUE(encode_file(source, at("whole.tess"), o).status());
    const std::string whole = contents_of(folder_).at("whole.tess");
    for (int n = 1;; ++n) {
        o.journal = JournalUse::start;
        {
            const Fault fault(Call::write, n);
            const Status status = encode_file(source, at("x.tess"), o).status();
            if (!fault.happened())
                break;
            EXPECT_EQ(status.code(), ErrorCode::io);
        }
        o.journal = JournalUse::resume;
        const auto report = encode_file(source, at("x.tess"), o);
        ASSERT_TRUE(report) << report.status().message();
        EXPECT_TRUE(contents_of(folder_).at("x.tess") == whole) << "write " << n;
    }
}

TEST_F(FailingWrites, DecodeAndBakeToPlainFiles) {
    std::vector<std::byte> bytes;
    ASSERT_TRUE(encode_memory(*baked_, bytes, options()).status());
    const auto file = wrap_memory(bytes);
    const auto decoder = Decoder::open(*file);
    ASSERT_TRUE(decoder);
    for (const std::string name : {"x.rgb", "x.exr", "x_views/"}) {
        const std::string shown = name.substr(0, name.find('/'));
        fail_everything(shown, [&]() -> Status {
            auto sink = create_texture(at(name), baked_->desc(), {}, 2);
            TESSERA_TRY(sink.status());
            return decoder->decode(Box4::whole(written_size), **sink, 2);
        });
        fail_everything(shown, [&]() -> Status {
            auto sink = create_texture(at(name), baked_->desc(), {}, 2);
            TESSERA_TRY(sink.status());
            return copy_texture(*baked_, **sink, 2, {}, "baking");
        });
    }
}

// Uses a real file system that is full.
TEST_F(FailingWrites, FullDisk) {
    const std::string disk = at("disk");
    fs::create_directory(disk);
    if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=16k") != 0)
        GTEST_SKIP() << "cannot mount a small tmpfs here (not root?)";
    std::ofstream(disk + "/x.tess") << "old";
    EncodeOptions o = options();
    o.rate.value = 100;
    o.journal = JournalUse::start;
    const auto busy = corpus::make_baked_source("mirror", written_size, 1, 1); // fills the disk
    ASSERT_TRUE(busy.ok());
    const Status full = encode_file(**busy, disk + "/x.tess", o).status();
    const auto left = contents_of(disk);
    // With more room, resuming uses the kept tiles.
    const int remounted = ::mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, "size=4m");
    o.journal = JournalUse::resume;
    const Status resumed = encode_file(**busy, disk + "/x.tess", o).status();
    const auto after = contents_of(disk);
    ::umount(disk.c_str());
    EXPECT_EQ(full.code(), ErrorCode::io) << full.message();
    EXPECT_NE(full.message().find("No space left"), std::string::npos) << full.message();
    EXPECT_EQ(left.at("x.tess"), "old");
    EXPECT_EQ(left.count("x.tess.journal"), full.message().find("kept in") != std::string::npos);
    ASSERT_EQ(remounted, 0);
    EXPECT_TRUE(resumed) << resumed.message();
    EXPECT_EQ(after.size(), 1u);
    EXPECT_GT(after.at("x.tess").size(), 8000u);
}

} // namespace
} // namespace tessera
