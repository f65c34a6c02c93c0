#include "format/byte_source.h"

#include "format/io/system_calls.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>

namespace tessera {

namespace {

class FileSource : public ByteSource {
public:
    FileSource(int descriptor, std::uint64_t size, std::string path)
        : descriptor_(descriptor), size_(size), path_(std::move(path)) {}
    ~FileSource() override { sys::drop(descriptor_); }
    FileSource(const FileSource&) = delete;
    FileSource& operator=(const FileSource&) = delete;

    std::uint64_t size() const override { return size_; }
    std::string name() const override { return path_; }

    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        TESSERA_TRY(check_range(*this, offset, out.size()));
        while (!out.empty()) {
            const std::int64_t got = sys::read_at(descriptor_, out, offset);
            const std::string what = "cannot read at offset " + std::to_string(offset);
            if (got < 0)
                return sys::system_error(path_, what, errno);
            if (got == 0)
                return {ErrorCode::io, path_ + ": " + what + ": the file became shorter"};
            offset += static_cast<std::uint64_t>(got);
            out = out.subspan(static_cast<std::size_t>(got));
        }
        return {};
    }

private:
    int descriptor_;
    std::uint64_t size_;
    std::string path_;
};

class MemoryBytes : public ByteSource {
public:
    explicit MemoryBytes(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::uint64_t size() const override { return bytes_.size(); }
    std::string name() const override { return "<memory>"; }

    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        TESSERA_TRY(check_range(*this, offset, out.size()));
        if (!out.empty())
            std::memcpy(out.data(), bytes_.data() + offset, out.size());
        return {};
    }

private:
    std::span<const std::byte> bytes_;
};

} // namespace

Status check_range(const ByteSource& source, std::uint64_t offset, std::uint64_t length) {
    if (offset <= source.size() && length <= source.size() - offset)
        return {};
    return {ErrorCode::io, source.name() + ": cannot read " + std::to_string(length) +
                               " bytes at offset " + std::to_string(offset) + " of " +
                               std::to_string(source.size())};
}

Status ByteSource::read_many(std::span<const ReadRequest> requests) {
    for (const ReadRequest& request : requests)
        TESSERA_TRY(read(request.offset, request.out));
    return {};
}

Result<std::unique_ptr<ByteSource>> open_file(const std::string& path) {
    const int descriptor = sys::open(path, sys::Access::read);
    if (descriptor < 0)
        return sys::system_error(path, "cannot open", errno);
    using Kind = sys::FileFacts::Kind;
    sys::FileFacts facts;
    const int failed = sys::facts_of(descriptor, facts) < 0 ? errno : 0;
    if (failed == 0 && facts.kind == Kind::file)
        return std::unique_ptr<ByteSource>(
            std::make_unique<FileSource>(descriptor, facts.size, path));
    sys::drop(descriptor);
    if (failed != 0)
        return sys::system_error(path, "cannot read its size", failed);
    return Status(ErrorCode::io,
                  path + ": cannot open: it is " +
                      (facts.kind == Kind::folder ? "a directory" : "not a regular file"));
}

std::unique_ptr<ByteSource> wrap_memory(std::span<const std::byte> bytes) {
    return std::make_unique<MemoryBytes>(bytes);
}

// One lock serves all objects, so that the class stays movable. It need not be fast.
static std::mutex counting_mutex;

Status CountingByteSource::read(std::uint64_t offset, std::span<std::byte> out) {
    {
        const std::lock_guard lock(counting_mutex);
        reads_.push_back({offset, out.size()});
    }
    return inner_.read(offset, out);
}

Status CountingByteSource::read_many(std::span<const ReadRequest> requests) {
    for (const ReadRequest& request : requests)
        TESSERA_TRY(check_range(*this, request.offset, request.out.size()));
    {
        const std::lock_guard lock(counting_mutex);
        for (const MergedRead& read : merge_reads(requests))
            reads_.push_back({read.offset, read.length});
    }
    return inner_.read_many(requests);
}

} // namespace tessera
