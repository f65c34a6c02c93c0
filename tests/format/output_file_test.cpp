// Tests that output files appear complete or not at all, and reading files as byte sources.
#include "format/byte_source.h"
#include "format/container/syntax.h"
#include "format/io/bit_reader.h"
#include "format/io/system_calls.h"
#include "format/levels.h"
#include "format/output_file.h"
#include "tests/support/files_in_folder.h"
#include "tests/support/format_bytes.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test;

class Files : public FilesInFolder {};

TEST_F(Files, AppearsWhenCommitted) {
    const std::string target = path("a.tess");
    {
        Result<OutputFile> file = OutputFile::create(target);
        ASSERT_TRUE(file) << file.status().message();
        ASSERT_TRUE(file->append(bytes_of("hello ")));
        ASSERT_TRUE(file->append(bytes_of("world")));
        ASSERT_TRUE(file->write_at(0, bytes_of("J")));
        EXPECT_EQ(file->appended(), 11u);
        EXPECT_FALSE(std::filesystem::exists(target));
        OutputFile moved = std::move(*file);
        ASSERT_TRUE(moved.commit());
        EXPECT_EQ(moved.commit().code(), ErrorCode::io);
        EXPECT_EQ(moved.append(bytes_of("x")).code(), ErrorCode::io);
    }
    EXPECT_EQ(test::slurp(target), "Jello world");
    EXPECT_EQ(files(), 1);
}

TEST_F(Files, LeavesNothingBehindWithoutCommit) {
    const std::string target = path("a.tess");
    std::ofstream(target) << "old";
    {
        Result<OutputFile> file = OutputFile::create(target);
        ASSERT_TRUE(file && file->append(bytes_of("new")));
        EXPECT_EQ(files(), 2);
    }
    EXPECT_EQ(test::slurp(target), "old");
    EXPECT_EQ(files(), 1);
}

TEST_F(Files, IgnoresAStaleTemporaryFile) {
    const std::string target = path("a.tess");
    std::ofstream(target + "." + std::to_string(sys::process_id()) + ".tmp") << "stale";
    Result<OutputFile> file = OutputFile::create(target);
    ASSERT_TRUE(file && file->append(bytes_of("new")) && file->commit());
    EXPECT_EQ(test::slurp(target), "new");
}

TEST_F(Files, FailingRename) {
    const std::string target = path("a");
    Result<OutputFile> file = OutputFile::create(target);
    ASSERT_TRUE(file && file->append(bytes_of("x")));
    std::filesystem::create_directory(target); // appears during the write
    expect_io_error(file->commit(), target, "rename");
    EXPECT_EQ(files(), 1);
}

TEST_F(Files, FoldersReplaceFolders) {
    for (const char* const name : {"first", "second"}) {
        Result<OutputFolder> folder = OutputFolder::create(path("views"));
        ASSERT_TRUE(folder) << folder.status().message();
        ASSERT_TRUE(folder->add(name, bytes_of(name)));
        const Status status = folder->commit();
        EXPECT_TRUE(status) << status.message();
        EXPECT_EQ(slurp(path("views") + "/" + name), name);
        EXPECT_EQ(files(), 1);
    }
    EXPECT_FALSE(std::filesystem::exists(path("views/first")));
}

TEST_F(Files, FoldersCanBeMoved) {
    {
        Result<OutputFolder> first = OutputFolder::create(path("first"));
        Result<OutputFolder> second = OutputFolder::create(path("second"));
        ASSERT_TRUE(first && first->add("a", bytes_of("a")));
        OutputFolder* const same = &*first;
        *first = std::move(*same);
        OutputFolder kept;
        kept = std::move(*first);
        EXPECT_TRUE(kept.commit()) << "a moved folder cannot be committed";
    }
    EXPECT_EQ(slurp(path("first/a")), "a");
    EXPECT_EQ(files(), 1) << "the other folder was not discarded";
}

TEST_F(Files, NamesInAFolder) {
    std::error_code error = std::make_error_code(std::errc::io_error);
    EXPECT_EQ(names_in(folder_.string(), error), std::vector<std::string>());
    EXPECT_FALSE(error);
    std::ofstream(path("a")).close();
    ASSERT_EQ(sys::make_folder(folder_.string() + "/größe €"), 0);
    std::vector<std::string> names = names_in(folder_.string(), error);
    std::ranges::sort(names);
    EXPECT_EQ(names, (std::vector<std::string>{"a", "größe €"}));
    EXPECT_EQ(names_in(path("none"), error), std::vector<std::string>());
    EXPECT_EQ(error, std::errc::no_such_file_or_directory);
}

TEST_F(Files, ReadsSources) {
    std::ofstream(path("a")) << "0123456789";
    Result<std::unique_ptr<ByteSource>> file = open_file(path("a"));
    ASSERT_TRUE(file) << file.status().message();
    const std::string digits = "0123456789";
    std::unique_ptr<ByteSource> memory = wrap_memory(bytes_of(digits));
    for (ByteSource* source : {file->get(), memory.get()}) {
        EXPECT_EQ(source->size(), 10u);
        CountingByteSource counting(*source);
        std::array<std::byte, 4> four;
        ASSERT_TRUE(counting.read(6, four));
        EXPECT_EQ(four[3], std::byte{'9'});
        EXPECT_EQ(counting.read(7, four).code(), ErrorCode::io);
        EXPECT_EQ(counting.read(~0ull - 1, four).code(), ErrorCode::io);
        EXPECT_TRUE(counting.read(10, {}));
        ASSERT_EQ(counting.reads().size(), 4u);
        EXPECT_EQ(counting.reads()[0].offset, 6u);
        EXPECT_EQ(counting.reads()[0].length, 4u);
    }
    std::filesystem::resize_file(path("a"), 5);
    std::array<std::byte, 4> four;
    expect_io_error((*file)->read(4, four), path("a"), "shorter");
}

TEST_F(Files, ReadsManyRanges) {
    std::ofstream(path("a")) << "0123456789";
    Result<std::unique_ptr<ByteSource>> file = open_file(path("a"));
    ASSERT_TRUE(file) << file.status().message();
    const std::string digits = "0123456789";
    std::unique_ptr<ByteSource> memory = wrap_memory(bytes_of(digits));
    for (ByteSource* source : {file->get(), memory.get()}) {
        CountingByteSource counting(*source);
        std::array<std::byte, 2> a, b, c;
        const ReadRequest three[] = {{6, a}, {0, b}, {5, c}};
        ASSERT_TRUE(counting.read_many(three));
        EXPECT_EQ(a[1], std::byte{'7'});
        EXPECT_EQ(b[0], std::byte{'0'});
        EXPECT_EQ(c[0], std::byte{'5'});
        ASSERT_EQ(counting.reads().size(), 1u) << "nearby ranges were not read in one request";
        EXPECT_EQ(counting.reads()[0].offset, 0u);
        EXPECT_EQ(counting.reads()[0].length, 8u);
        const ReadRequest outside[] = {{0, a}, {9, b}};
        EXPECT_EQ(counting.read_many(outside).code(), ErrorCode::io);
        EXPECT_EQ(source->read_many(outside).code(), ErrorCode::io);
        EXPECT_TRUE(counting.read_many({}));
        EXPECT_FALSE(counting.wants_prefetch());
    }
}

} // namespace
} // namespace tessera
