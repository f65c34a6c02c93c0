// The library tinygltf is a header; this is its implementation.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
