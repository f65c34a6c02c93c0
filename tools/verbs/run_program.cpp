#include "tools/verbs/run_program.h"

#include "format/status.h"
#include "tools/support/interrupt.h"
#include "tools/verbs/run_tool.h"

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

namespace tessera {

int run_program(int argc, char** argv, std::span<const Verb> verbs,
                const std::function<int()>& who_knows_more) {
    int code = static_cast<int>(ErrorCode::runtime);
    install_signal_handlers();
    try {
        code = run_tool(argc, argv, verbs, who_knows_more);
    } catch (const std::bad_alloc&) {
        std::fputs("tessera: error: out of memory\n", stderr);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "tessera: error: %s\n", e.what());
    } catch (...) {
        std::fputs("tessera: error: unknown failure\n", stderr);
    }
    if (const int signal = interrupted_by(); signal != 0 && code != 0) {
        std::signal(signal, SIG_DFL); // so that a shell sees why we ended
        std::raise(signal);
    }
    return code;
}

} // namespace tessera
