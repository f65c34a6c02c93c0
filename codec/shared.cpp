// CMake requires a source file for libtessera.so, which consists of the static libraries.
