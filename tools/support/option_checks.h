// How options are declared: headings of the help, and checks of values with messages in plain
// words.
#pragma once

#include "format/status.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

// Bytes of "20000", "20k", "3M", "1.5GiB". K, M, G and T, in either case, are powers of 1024.
// Errors: bad_argument.
Result<std::uint64_t> parse_size(const std::string& text);

// Declares options under one heading of the help.
class OptionGroup {
public:
    OptionGroup(CLI::App& app, const char* heading) : app_(app), heading_(heading) {}
    // `value` stands for the value in the help: "--size UxVxSxT".
    template <class T>
    CLI::Option* option(const char* name, const std::string& value, T& target,
                        const std::string& help) {
        return app_.add_option(name, target, help)->option_text(value)->group(heading_);
    }
    template <class T>
    CLI::Option* option(const char* name, const std::string& value, T& target,
                        const std::string& help, const CLI::Validator& check) {
        return option(name, value, target, help)->check(check);
    }
    CLI::Option* flag(const char* name, bool& target, const std::string& help) {
        return app_.add_flag(name, target, help)->group(heading_);
    }

private:
    CLI::App& app_;
    const char* heading_;
};

// A number from `low` to `high`.
CLI::Validator number_between(double low, double high);

// One of these words; the error for another one suggests the nearest.
CLI::Validator one_of(std::vector<std::string> words);

// A size for parse_size(), from `low` to `high` bytes. The option receives the number of bytes.
CLI::Validator size_between(std::uint64_t low, std::uint64_t high);

// A size for parse_size(), from 1 MiB to 1 TiB. The option receives the number of MiB, rounded up.
CLI::Validator size_in_mebibytes();

} // namespace tessera
