// Checks of option values, done while the command line is parsed, with messages in plain words.
#pragma once

#include "format/status.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

// Bytes of "20000", "20k", "3M", "1.5GiB". K, M, G and T, in either case, are powers of 1024. Errors:
// bad_argument.
Result<std::uint64_t> parse_size(const std::string& text);

// A number from `low` to `high`.
CLI::Validator number_between(double low, double high);

// One of these words; the error for another one suggests the nearest.
CLI::Validator one_of(std::vector<std::string> words);

// A size for parse_size(), from `low` to `high` bytes. The option receives the number of bytes.
CLI::Validator size_between(std::uint64_t low, std::uint64_t high);

// A size for parse_size(), from 1 MiB to 1 TiB. The option receives the number of MiB, rounded up.
CLI::Validator size_in_mebibytes();

} // namespace tessera
