// The tool `tessera`. The loader has little to bring for it, so that it starts in a third of the time: ray tracing,
// models, GPUs and servers are in `tessera-full`, which it becomes for their verbs.
#include "tools/verbs/program.h"

int main(int argc, char** argv) {
    return tessera::quick_program(argc, argv);
}
