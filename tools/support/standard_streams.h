// "-": standard input and output in place of a file, for kinds that are one file.
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

// What stands on standard input. A file that was redirected is read in place; of a pipe everything is
// read first, at most 1 GiB, and kept: later calls see the same bytes. Errors: io; bad_argument (a
// terminal); unsupported (a pipe with more); runtime (interrupted).
Result<std::unique_ptr<ByteSource>> open_standard_input();

// --json beside `output`: both cannot have standard output. Errors: bad_argument.
Status check_json_output(bool json, const std::string& output);

// Where lines for people go beside `output`: standard error if that is standard output.
std::FILE* summary_stream(const std::string& output);

// Whether texels or a file may go there. Errors: bad_argument (a terminal).
Status check_standard_output();
Status write_standard_output(std::span<const std::byte> bytes);
Status flush_standard_output();

} // namespace tessera
