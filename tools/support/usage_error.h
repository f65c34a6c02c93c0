// Why a command line cannot be understood, in the words that were typed.
#pragma once

#include "format/status.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tessera {

// What is wrong before anything is parsed: `-q 50`, where -q is --quiet. `words`: those after the verb.
Status check_words(const CLI::App& verb, const std::vector<std::string>& words);

// `error` of parsing for `verb` (nullptr: there was none). An unknown option is what is wrong even
// where something else is missing, too: it usually is what was meant.
Status usage_error(const CLI::App& app, const CLI::App* verb, const CLI::ParseError& error);

} // namespace tessera
