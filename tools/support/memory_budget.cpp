#include "tools/support/memory_budget.h"

#include "format/work.h"
#include "tools/support/option_checks.h"

#include <algorithm>

namespace tessera {
namespace {

// Generous upper bounds, from measurements: the program with its libraries, tables and the index of
// the largest texture; and one thread of the encoder.
constexpr std::uint64_t fixed_bytes = 76ull << 20;
constexpr std::uint64_t thread_bytes = 16ull << 20;
// The share of the rest that slabs get. Packing a picture holds parts of it a second time.
constexpr double slab_share = 0.75;

} // namespace

void add_memory_option(CLI::App& app, std::string& text) {
    text = usual_memory;
    app.add_option("--memory", text,
                   "Most memory to use, such as 512M or 2G. Default: " + std::string(usual_memory))
        ->option_text("SIZE");
}

Result<std::uint64_t> slab_budget(const std::string& text, unsigned threads) {
    TESSERA_TRY_ASSIGN(const auto memory, parse_size(text).with_context("--memory"));
    const std::uint64_t needed = fixed_bytes + thread_count(threads) * thread_bytes;
    const std::uint64_t least = needed + (16ull << 20);
    if (memory < least)
        return Status(ErrorCode::bad_argument, "--memory: " + text + " is not enough; " +
                                                   std::to_string(thread_count(threads)) +
                                                   " threads need at least " +
                                                   std::to_string((least >> 20) + 1) + "M");
    return static_cast<std::uint64_t>(static_cast<double>(memory - needed) * slab_share);
}

DecodeOptions within_budget(DecodeOptions options, std::uint64_t slab_bytes, unsigned files) {
    options.most_head_bytes = std::min(options.most_head_bytes, slab_bytes / 4 / files);
    return options;
}

Status with_memory_hint(const Status& status) {
    return status.code() == ErrorCode::over_budget
               ? Status(status.code(), status.message() + "; a larger --memory helps")
               : status;
}

} // namespace tessera
