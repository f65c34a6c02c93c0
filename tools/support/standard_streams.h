// "-" as a file name: standard input or output.
#pragma once

#include "format/byte_source.h"
#include "format/status.h"

#include <cstddef>
#include <cstdio>
#include <memory>
#include <span>
#include <string>

namespace tessera {

inline constexpr const char* standard_stream = "-"; // as a file's name

// Opens standard input. A redirected file is read in place. A pipe is first read to its end, at
// most 1 GiB, and later calls return the same bytes. Errors: io; bad_argument (a terminal);
// unsupported (a longer pipe); runtime (interrupted).
Result<std::unique_ptr<ByteSource>> open_standard_input();

// Whether --json and `output` would both use standard output. Errors: bad_argument.
Status check_json_output(bool json, const std::string& output);

// The stream for summaries: standard error if `output` is standard output, else standard output.
std::FILE* summary_stream(const std::string& output);

// Whether standard output accepts binary data. Errors: bad_argument (a terminal).
Status check_standard_output();
Status write_standard_output(std::span<const std::byte> bytes);
Status flush_standard_output();

} // namespace tessera
