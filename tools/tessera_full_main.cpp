#include "tools/verbs/program.h"

int main(int argc, char** argv) {
    return tessera::full_program(argc, argv);
}
