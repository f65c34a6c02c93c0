// The program `tessera`: what concerns the whole process, around run_tool().
#include "format/status.h"
#include "tools/support/interrupt.h"
#include "tools/support/system.h"
#include "tools/verbs/command.h"

#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>
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
    tessera::set_up_standard_streams();
    tessera::install_signal_handlers();
    try {
        std::vector<std::string> words = tessera::command_line(argc, argv);
        std::vector<char*> pointers;
        for (std::string& word : words)
            pointers.push_back(word.data());
        pointers.push_back(nullptr);
        code = tessera::run_tool(static_cast<int>(words.size()), pointers.data());
    } catch (const std::bad_alloc&) {
        std::fputs("tessera: error: out of memory\n", stderr);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "tessera: error: %s\n", e.what());
    } catch (...) {
        std::fputs("tessera: error: unknown failure\n", stderr);
    }
    if (const int signal = tessera::interrupted_by(); signal != 0 && code != 0)
        tessera::end_by_signal(signal);
    return code;
}
