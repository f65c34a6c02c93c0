// EXT_meshopt_compression, by meshoptimizer. It trusts the sizes of elements, which are checked here.
#include "corpus/model/readers.h"

#include <meshoptimizer.h>

namespace tessera::corpus {
namespace {

// Whether meshoptimizer's preconditions hold.
bool is_possible(const MeshoptUse& use) {
    const std::size_t stride = use.stride;
    if (use.mode == "ATTRIBUTES")
        return stride % 4 == 0 && stride <= 256 &&
               (use.filter.empty() || use.filter == "NONE" ||
                (use.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
                (use.filter == "QUATERNION" && stride == 8) || use.filter == "EXPONENTIAL");
    return (use.mode == "TRIANGLES" || use.mode == "INDICES") && (stride == 2 || stride == 4) &&
           (use.filter.empty() || use.filter == "NONE") &&
           (use.mode == "INDICES" || use.count % 3 == 0);
}

int decode(std::span<const unsigned char> stream, const MeshoptUse& use, unsigned char* out) {
    const auto [mode, filter, stride, count] = use;
    if (mode == "TRIANGLES")
        return meshopt_decodeIndexBuffer(out, count, stride, stream.data(), stream.size());
    if (mode == "INDICES")
        return meshopt_decodeIndexSequence(out, count, stride, stream.data(), stream.size());
    const int result = meshopt_decodeVertexBuffer(out, count, stride, stream.data(), stream.size());
    if (result != 0)
        return result;
    if (filter == "OCTAHEDRAL")
        meshopt_decodeFilterOct(out, count, stride);
    else if (filter == "QUATERNION")
        meshopt_decodeFilterQuat(out, count, stride);
    else if (filter == "EXPONENTIAL")
        meshopt_decodeFilterExp(out, count, stride);
    return 0;
}

} // namespace

Result<std::vector<unsigned char>> decode_meshopt(std::span<const unsigned char> stream,
                                                  const MeshoptUse& use) {
    const std::string what = "EXT_meshopt_compression, mode " + use.mode.substr(0, longest_shown) +
                             (use.filter.empty() ? "" : ", filter ") +
                             use.filter.substr(0, longest_shown);
    if (!is_possible(use))
        return invalid_gltf(what + ", cannot have elements of " + std::to_string(use.stride) +
                            " bytes");
    // Vertices take a bit for each byte of 16 of them, triangles a byte.
    if (use.count / 512 > stream.size())
        return invalid_gltf(what + ": " + std::to_string(stream.size()) + " bytes cannot hold " +
                            std::to_string(use.count) + " elements");
    std::vector<unsigned char> out(use.count * use.stride);
    if (decode(stream, use, out.data()) != 0)
        return invalid_gltf(what + ": damaged");
    return out;
}

} // namespace tessera::corpus
