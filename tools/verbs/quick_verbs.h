// The verbs that need the codec and pictures, but no scene, GPU or server.
#pragma once

#include "tools/verbs/command.h"

#include <span>

namespace tessera {

void add_encode_command(CLI::App& app, Invocation& chosen);
void add_decode_command(CLI::App& app, Invocation& chosen);
void add_info_command(CLI::App& app, Invocation& chosen);
void add_validate_command(CLI::App& app, Invocation& chosen);
void add_sheet_command(CLI::App& app, Invocation& chosen);

std::span<const Verb> quick_verbs();

} // namespace tessera
