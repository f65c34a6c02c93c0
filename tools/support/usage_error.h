// Explains why a command line is wrong, in the words that were typed.
#pragma once

#include "format/status.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tessera {

// Finds mistakes that parsing would accept: `-q 50`, where -q is --quiet. `words`: those after the
// verb.
Status check_words(const CLI::App& verb, const std::vector<std::string>& words);

// Explains `error`, which parsing for `verb` threw (nullptr: no verb was given). Prefers an unknown
// option to a missing one, because the unknown one usually is a misspelling of it.
Status usage_error(const CLI::App& app, const CLI::App* verb, const CLI::ParseError& error);

} // namespace tessera
