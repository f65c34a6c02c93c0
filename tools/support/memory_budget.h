// --memory: how much memory a verb may use, and how much of it is left for texels.
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

// Bytes of texels that a slab may hold, so that a process with `threads` threads (0: all cores)
// stays within the budget `text`. Errors: bad_argument, also if the budget is too small for the
// program and its threads.
Result<std::uint64_t> slab_budget(const std::string& text, unsigned threads);

// `options` with a limit for the heads of files, so that `files` files can be open at once beside
// slabs of `slab_bytes`.
DecodeOptions within_budget(DecodeOptions options, std::uint64_t slab_bytes, unsigned files = 1);

// `status`; if a slab was too large, with a hint to --memory.
Status with_memory_hint(const Status& status);

} // namespace tessera
