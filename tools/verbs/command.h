// Verbs of the tool. Each command_<verb>.cpp declares its options and says what they do.
#pragma once

#include "format/status.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

namespace tessera {

// What the parsed command line asks for; set by the verb that was named.
struct Invocation {
    std::function<Status()> run;
    std::string verb;
};

struct Verb {
    const char* name;
    void (*add)(CLI::App& app, Invocation& chosen);
};

// At the end of every help.
inline constexpr const char* exit_codes_help =
    "Exit codes: 0 success, 1 usage, 2 input/output, 3 invalid file, 4 runtime,\n"
    "5 not supported, 6 target missed, 7 difference found.";

// Declares a verb whose options live in `Arguments` and whose work is run(const Arguments&).
template <class Arguments, class Declare>
void add_verb(CLI::App& app, Invocation& chosen, const char* verb, const char* summary,
              const char* examples, const Declare& declare,
              Status (*run)(const Arguments& arguments)) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand(verb, summary);
    command->footer(std::string(examples) + "\n\n" + exit_codes_help);
    declare(*command, *arguments);
    command->callback([&chosen, arguments, verb, run] {
        chosen.verb = verb;
        chosen.run = [arguments, run] { return run(*arguments); };
    });
}

} // namespace tessera
