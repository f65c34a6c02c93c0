// The implementation of tinygltf, which is a header-only library.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
