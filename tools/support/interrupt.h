// Turns Ctrl-C and kill into an ordinary error, so that temporary files are removed on the way out.
#pragma once

#include "format/texture.h"

#include <memory>

namespace tessera {

// Records SIGINT and SIGTERM. A process that has not ended 0.7 s after the first signal is ended,
// and its unfinished outputs are removed; a second signal later ends it at once. Ignores SIGXFSZ
// and SIGPIPE, so that the write returns the error. Call it once.
void install_signal_handlers();

// The number of the received signal, or 0.
int interrupted_by();

// Errors: runtime, "interrupted", after a signal.
Status check_interrupt();

// Like `inner`, but read() and write() fail with "interrupted" after a signal.
std::unique_ptr<TexelSource> interruptible(std::unique_ptr<TexelSource> inner);
std::unique_ptr<TexelSink> interruptible(std::unique_ptr<TexelSink> inner);

} // namespace tessera
