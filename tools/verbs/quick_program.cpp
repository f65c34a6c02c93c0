#include "format/status.h"
#include "tools/support/interrupt.h"
#include "tools/verbs/program.h"
#include "tools/verbs/quick_verbs.h"
#include "tools/verbs/run_program.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <unistd.h>

namespace tessera {
namespace {

// Returns only where it cannot be started: it has said why, and this is the exit code.
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

} // namespace

int quick_program(int argc, char** argv) {
    return run_program(argc, argv, quick_verbs(), [argv] { return become_full_program(argv); });
}

} // namespace tessera
