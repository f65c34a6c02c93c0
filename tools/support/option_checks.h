// What an option's value may be, checked while the command line is read and told in plain words.
#pragma once

#include "format/status.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

// "20000", "20k", "3M", "1.5GiB": bytes; K, M, G and T, in either case, are powers of 1024. Errors:
// bad_argument.
Result<std::uint64_t> parse_size(const std::string& text);

// A number from `low` to `high`.
CLI::Validator number_between(double low, double high);

// One of these words; another is answered with the nearest.
CLI::Validator one_of(std::vector<std::string> words);

// A size as parse_size() has it, from `low` to `high` bytes; the option gets it in bytes.
CLI::Validator size_between(std::uint64_t low, std::uint64_t high);

// MiB from 1 to 2^20: a plain number of them, or a size with its unit, rounded up; the option gets MiB.
CLI::Validator mebibytes();

} // namespace tessera
