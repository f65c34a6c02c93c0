#include "tools/verbs/program.h"

#include "format/status.h"
#include "tools/support/interrupt.h"
#include "tools/verbs/run_tool.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <unistd.h>

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

int become_full_program(char** argv) {
    namespace fs = std::filesystem;
    if (interrupted_by() != 0)
        return static_cast<int>(ErrorCode::runtime);
    std::error_code failed;
    const fs::path here = fs::read_symlink("/proc/self/exe", failed).parent_path();
    std::string why;
    for (const fs::path& path : {here / "tessera-full", here / TESSERA_FULL_PROGRAM}) {
        ::execv(path.c_str(), argv);
        why = path.lexically_normal().string() + ": " + std::strerror(errno);
    }
    std::fprintf(stderr, "tessera: error: %s (this verb is in it)\n", why.c_str());
    return static_cast<int>(ErrorCode::runtime);
}

} // namespace tessera
