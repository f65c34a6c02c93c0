// All of the tool, `tessera-full`.
#include "tools/full_verbs/all_verbs.h"
#include "tools/verbs/program.h"

int main(int argc, char** argv) {
    return tessera::run_program(argc, argv, tessera::all_verbs());
}
