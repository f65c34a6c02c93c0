// The program `tessera`: what concerns the whole process, around run_tool().
#include "format/status.h"
#include "tools/support/interrupt.h"
#include "tools/verbs/command.h"

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

// Slabs and tiles are allocated and freed all the time. Memory that goes back to the kernel has its
// pages cleared again at the next allocation.
void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int largest_kept = 32 << 20, most_kept = 64 << 20; // bytes
    mallopt(M_MMAP_THRESHOLD, largest_kept);
    mallopt(M_TRIM_THRESHOLD, most_kept);
#endif
}

} // namespace

int main(int argc, char** argv) {
    int code = static_cast<int>(tessera::ErrorCode::runtime);
    keep_freed_memory();
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
        std::signal(signal, SIG_DFL); // so that a shell sees the signal as the reason
        std::raise(signal);
    }
    return code;
}
