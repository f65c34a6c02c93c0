// The verbs of the tool. Each command_<verb>.cpp declares the options of one verb and runs it.
#pragma once

#include "format/status.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace tessera {

// The verb that the command line names, with its parsed options.
struct Invocation {
    std::function<Status()> run;
    std::string verb;
};

struct Verb {
    const char* name;
    void (*add)(CLI::App& app, Invocation& chosen);
};

// Runs the verb that the command line names. Prints errors to standard error. Returns the exit code.
int run_tool(int argc, char** argv);

// All verbs except `help` and `version`, in the order of `tessera help`.
std::span<const Verb> all_verbs();

void add_bake_command(CLI::App& app, Invocation& chosen);
void add_bench_command(CLI::App& app, Invocation& chosen);
void add_compare_command(CLI::App& app, Invocation& chosen);
void add_convert_command(CLI::App& app, Invocation& chosen);
void add_decode_command(CLI::App& app, Invocation& chosen);
void add_encode_command(CLI::App& app, Invocation& chosen);
void add_fit_command(CLI::App& app, Invocation& chosen);
void add_info_command(CLI::App& app, Invocation& chosen);
void add_rd_command(CLI::App& app, Invocation& chosen);
void add_render_command(CLI::App& app, Invocation& chosen);
void add_serve_command(CLI::App& app, Invocation& chosen);
void add_shaders_command(CLI::App& app, Invocation& chosen);
void add_sheet_command(CLI::App& app, Invocation& chosen);
void add_validate_command(CLI::App& app, Invocation& chosen);
void add_view_command(CLI::App& app, Invocation& chosen);

// The last lines of every help text.
inline constexpr const char* exit_codes_help =
    "Exit codes: 0 success, 1 usage, 2 input/output, 3 invalid file, 4 runtime, "
    "5 not supported, 6 target missed, 7 difference found.";

// Declares a verb. declare(command, arguments) adds its options, which fill `arguments`;
// run(arguments) does its work.
template <class Arguments>
void add_verb(CLI::App& app, Invocation& chosen, const char* verb, const char* summary,
              const char* examples, void (*declare)(CLI::App& command, Arguments& arguments),
              Status (*run)(const Arguments& arguments)) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand(verb, summary);
    command->get_help_ptr()->group(""); // would be the first option of every help
    command->footer(std::string(examples) + "\n\n" + exit_codes_help);
    declare(*command, *arguments);
    command->callback([&chosen, arguments, verb, run] {
        chosen.verb = verb;
        chosen.run = [arguments, run] { return run(*arguments); };
    });
}

} // namespace tessera
