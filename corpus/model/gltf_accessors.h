// Reads the numbers of glTF accessors.
#pragma once

#include "corpus/model/readers.h"

#include <functional>
#include <tiny_gltf.h>

namespace tessera::corpus {

template <class Array> bool has(const Array& array, int index) {
    return index >= 0 && static_cast<std::size_t>(index) < array.size();
}

template <class Array> auto& at(const Array& array, int index) {
    return array[static_cast<std::size_t>(index)];
}

// The bytes of a bufferView. `who` has the view and is named in errors. Error: invalid_file.
Result<std::span<const unsigned char>> view_bytes(const tinygltf::Model& file, int index,
                                                  const std::string& who);

using PutNumber = std::function<void(std::size_t element, int component, double number)>;

// Calls put for every number of the accessor, whose elements must have `least` to `most`
// components. Elements without a bufferView are 0. A sparse accessor replaces some elements, whose
// numbers are put again. Returns the count of elements. Errors: invalid_file; unsupported (more
// than most_vertices elements).
Result<std::size_t> read_accessor(const tinygltf::Model& file, int index, int least, int most,
                                  const PutNumber& put);

// Fills `values` with the attribute of this name; empty if there is none. Components that the
// accessor lacks are `otherwise`. The errors of read_accessor() name the attribute.
template <class Vector>
Status read_attribute(const tinygltf::Model& file, const std::map<std::string, int>& attributes,
                      const std::string& name, std::vector<Vector>& values, int least,
                      float otherwise) {
    const auto it = attributes.find(name);
    if (it == attributes.end())
        return {};
    if (has(file.accessors, it->second) && at(file.accessors, it->second).count <= most_vertices)
        values.assign(at(file.accessors, it->second).count, Vector(otherwise));
    return read_accessor(
               file, it->second, least, Vector::length(),
               [&](std::size_t i, int c, double x) { values[i][c] = static_cast<float>(x); })
        .status()
        .with_context(name);
}

} // namespace tessera::corpus
