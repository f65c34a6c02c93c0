// --memory: how much a verb may hold, and what that leaves for texels.
#pragma once

#include "codec/decoder.h"
#include "format/status.h"
#include "format/texture.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

namespace tessera {

inline constexpr const char* usual_memory = "1GiB";

void add_memory_option(CLI::App& app, std::string& text);

// Bytes of texels that a slab may hold when a process with that many threads (0: all cores) is to
// stay within the budget `text`. Errors: bad_argument, also for a budget that not even the code and
// its threads fit.
Result<std::uint64_t> slab_budget(const std::string& text, unsigned threads);

// `options`, with the limit that keeps the heads of `files` files, open at once, within the budget that
// left `slab_bytes`.
DecodeOptions within_budget(DecodeOptions options, std::uint64_t slab_bytes, unsigned files = 1);

// `status`, with the option that would help, where a slab was too large.
Status with_memory_hint(const Status& status);

} // namespace tessera
