// The tool `tessera`: what outlives a command, signals and exceptions.
#include "format/status.h"
#include "tools/support/interrupt.h"
#include "tools/verbs/run_tool.h"

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

int main(int argc, char** argv) {
    int code = static_cast<int>(tessera::ErrorCode::runtime);
    tessera::install_signal_handlers();
    try {
        code = tessera::run_tool(argc, argv);
    } catch (const std::bad_alloc&) {
        std::fputs("tessera: error: out of memory\n", stderr);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "tessera: error: %s\n", e.what());
    } catch (...) {
        std::fputs("tessera: error: unknown failure\n", stderr);
    }
    if (const int signal = tessera::interrupted_by(); signal != 0 && code != 0) {
        std::signal(signal, SIG_DFL); // so that a shell sees why we ended
        std::raise(signal);
    }
    return code;
}
