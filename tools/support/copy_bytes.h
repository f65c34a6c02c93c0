// Copies a source of bytes into a file that is being written.
#pragma once

#include "format/byte_source.h"
#include "format/output_file.h"

namespace tessera {

// Appends all bytes of the source, a megabyte at a time. Errors: those of reading and writing; runtime
// (interrupted).
Status copy_bytes(ByteSource& from, OutputFile& to);

} // namespace tessera
