// Ctrl-C and kill, turned into an ordinary error so that every temporary file is removed on the way
// out.
#pragma once

#include "format/texture.h"

#include <memory>

namespace tessera {

// SIGINT and SIGTERM are remembered; what has not ended 0.7 s after the first is ended, without its
// unfinished outputs, and a later second one ends the program at once. Called once. SIGXFSZ and SIGPIPE are
// ignored: the write fails and says so.
void install_signal_handlers();

// The signal that came, or 0.
int interrupted_by();

// Errors: runtime, "interrupted", once one came.
Status check_interrupt();

// `inner`, but read() and write() fail with "interrupted" once a signal came.
std::unique_ptr<TexelSource> interruptible(std::unique_ptr<TexelSource> inner);
std::unique_ptr<TexelSink> interruptible(std::unique_ptr<TexelSink> inner);

} // namespace tessera
