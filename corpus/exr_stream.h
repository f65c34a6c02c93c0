// OpenEXR's streams over ours, and its exceptions as our Status.
#pragma once

#include "format/byte_source.h"
#include "format/output_file.h"
#include "format/status.h"

#include <ImfIO.h>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

namespace tessera {

// Carries a Status through OpenEXR.
class StatusError : public std::runtime_error {
public:
    explicit StatusError(Status s) : std::runtime_error(s.message()), status(std::move(s)) {}
    Status status;
};

class ExrInput : public Imf::IStream {
public:
    explicit ExrInput(ByteSource& file) : IStream(file.name().c_str()), file_(file) {}
    bool read(char c[], int n) override {
        if (n < 0 || position_ > file_.size() ||
            static_cast<std::uint64_t>(n) > file_.size() - position_)
            throw std::runtime_error("the file ends too early");
        const auto count = static_cast<std::size_t>(n);
        if (Status s = file_.read(position_, {reinterpret_cast<std::byte*>(c), count}); !s.ok())
            throw StatusError(s);
        position_ += count;
        return position_ < file_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

private:
    ByteSource& file_;
    std::uint64_t position_ = 0;
};

// OpenEXR writes its last bytes in a destructor, which cannot report errors. Callers check status()
// after it.
class ExrOutput : public Imf::OStream {
public:
    explicit ExrOutput(OutputFile& file) : OStream(file.path().c_str()), file_(file) {}
    void write(const char c[], int n) override {
        const auto count = static_cast<std::size_t>(n);
        if (status_.ok())
            status_ = file_.write_at(position_, {reinterpret_cast<const std::byte*>(c), count});
        if (!status_.ok())
            throw StatusError(status_);
        position_ += count;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }
    const Status& status() const { return status_; } // the first error

private:
    OutputFile& file_;
    std::uint64_t position_ = 0;
    Status status_;
};

// Most bytes that one call to OpenEXR reads or writes, in whole lines.
inline constexpr std::uint64_t max_chunk_bytes = 1ull << 24;

// Runs body(), which returns a Status and may call OpenEXR. Errors from our streams name the file.
template <class Body> Status guard_exr(const Body& body) {
    try {
        return body();
    } catch (const StatusError& e) {
        return e.status;
    } catch (const std::bad_alloc&) {
        return {ErrorCode::runtime, "out of memory"};
    } catch (const std::system_error& e) { // from OpenEXR's threads, not about the file
        return {ErrorCode::runtime,
                "a thread cannot be started: " + e.code().message() + "; try --threads"};
    } catch (const std::exception& e) {
        std::string reason = e.what();
        for (char& c : reason)
            if (c == '\n' || c == '\r')
                c = ' ';
        return {ErrorCode::invalid_file, "not a readable EXR picture: " + reason};
    } catch (...) {
        return {ErrorCode::runtime, "OpenEXR failed"};
    }
}

// Adds the file's name to an error, except to one of the operating system, which has it.
inline Status named(const Status& status, const std::string& path) {
    return status.code() == ErrorCode::io ? status : status.with_context(path);
}

template <class Body> Status guard_exr(const std::string& path, const Body& body) {
    return named(guard_exr(body), path);
}

} // namespace tessera
