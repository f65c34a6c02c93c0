#include "tools/support/standard_streams.h"

#include "tools/support/interrupt.h"
#include "tools/support/system.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

namespace tessera {
namespace {

constexpr std::size_t most_input_bytes = std::size_t{1} << 30;
constexpr std::size_t piece_bytes = std::size_t{1} << 16;

Status input_error(const std::string& text, ErrorCode code = ErrorCode::io) {
    return {code, "standard input: " + text};
}

// A source with the name "standard input" for messages.
class StandardInput : public ByteSource {
public:
    explicit StandardInput(std::unique_ptr<ByteSource> inner) : inner_(std::move(inner)) {}
    std::uint64_t size() const override { return inner_->size(); }
    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        return inner_->read(offset, out);
    }
    std::string name() const override { return "standard input"; }

private:
    std::unique_ptr<ByteSource> inner_;
};

Status read_pipe(std::vector<std::byte>& bytes) {
    while (true) {
        TESSERA_TRY(check_interrupt());
        const std::size_t before = bytes.size();
        bytes.resize(before + piece_bytes);
        const std::int64_t got = read_standard_input(std::span(bytes).subspan(before));
        bytes.resize(before + static_cast<std::size_t>(got < 0 ? 0 : got));
        if (got < 0 && errno != EINTR)
            return input_error(std::strerror(errno));
        if (got == 0)
            return {};
        if (bytes.size() > most_input_bytes)
            return input_error("a pipe is held in memory, so it has at most 1 GiB; redirect a file "
                               "(< FILE) or give its name",
                               ErrorCode::unsupported);
    }
}

} // namespace

Result<std::unique_ptr<ByteSource>> open_standard_input() {
    if (is_terminal(StandardStream::input))
        return input_error("is a terminal; '-' needs a pipe or a file (< FILE)",
                           ErrorCode::bad_argument);
    if (const std::string name = file_of_standard_input(); !name.empty()) {
        TESSERA_TRY_ASSIGN(auto file, open_file(name));
        return std::unique_ptr<ByteSource>(std::make_unique<StandardInput>(std::move(file)));
    }
    static std::vector<std::byte> bytes; // a pipe can be read once only
    static bool is_read = false;
    if (!is_read)
        TESSERA_TRY(read_pipe(bytes));
    is_read = true;
    return std::unique_ptr<ByteSource>(std::make_unique<StandardInput>(wrap_memory(bytes)));
}

Status check_json_output(bool json, const std::string& output) {
    if (json && output == standard_stream)
        return {ErrorCode::bad_argument, "--json and -o -: both write to standard output"};
    return {};
}

std::FILE* summary_stream(const std::string& output) {
    return output == standard_stream ? stderr : stdout;
}

Status check_standard_output() {
    if (is_terminal(StandardStream::output))
        return {ErrorCode::bad_argument,
                "standard output is a terminal; '-' needs a pipe or a file (> FILE)"};
    return {};
}

Status write_standard_output(std::span<const std::byte> bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) == bytes.size())
        return {};
    return {ErrorCode::io, std::string("standard output: ") + std::strerror(errno)};
}

Status flush_standard_output() {
    if (std::fflush(stdout) == 0)
        return {};
    return {ErrorCode::io, std::string("standard output: ") + std::strerror(errno)};
}

} // namespace tessera
