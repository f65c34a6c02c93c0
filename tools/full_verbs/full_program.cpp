#include "tools/full_verbs/all_verbs.h"
#include "tools/verbs/program.h"
#include "tools/verbs/run_program.h"

namespace tessera {

int full_program(int argc, char** argv) {
    return run_program(argc, argv, all_verbs());
}

} // namespace tessera
