#include "tools/verbs/run_program.h"

#include "format/status.h"
#include "tools/support/interrupt.h"
#include "tools/verbs/run_tool.h"

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace tessera {
namespace {

// Slabs and tiles come and go; each time the kernel would clear their pages anew.
void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int largest_kept = 32 << 20, most_kept = 64 << 20;
    mallopt(M_MMAP_THRESHOLD, largest_kept);
    mallopt(M_TRIM_THRESHOLD, most_kept);
#endif
}

} // namespace

int run_program(int argc, char** argv, std::span<const Verb> verbs,
                const std::function<int()>& who_knows_more) {
    int code = static_cast<int>(ErrorCode::runtime);
    keep_freed_memory();
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
