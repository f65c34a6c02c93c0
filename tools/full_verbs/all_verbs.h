// The verbs of the whole tool.
#pragma once

#include "tools/verbs/command.h"

#include <span>

namespace tessera {

void add_bake_command(CLI::App& app, Invocation& chosen);
void add_compare_command(CLI::App& app, Invocation& chosen);
void add_shaders_command(CLI::App& app, Invocation& chosen);
void add_render_command(CLI::App& app, Invocation& chosen);
void add_bench_command(CLI::App& app, Invocation& chosen);
void add_rd_command(CLI::App& app, Invocation& chosen);
void add_view_command(CLI::App& app, Invocation& chosen);
void add_serve_command(CLI::App& app, Invocation& chosen);

// In the order of `tessera help`, with the quick ones.
std::span<const Verb> all_verbs();

} // namespace tessera
