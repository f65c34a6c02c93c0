// The tool `tessera`. The loader has little to bring for it, so that it starts in a third of the time: ray tracing,
// models, GPUs and servers are in `tessera-full`, which it becomes for their verbs.
#include "tools/verbs/program.h"
#include "tools/verbs/quick_verbs.h"

int main(int argc, char** argv) {
    using namespace tessera;
    return run_program(argc, argv, quick_verbs(), [argv] { return become_full_program(argv); });
}
