#include "corpus/model/gltf_accessors.h"

#include <algorithm>
#include <cstring>

namespace tessera::corpus {
namespace {

using tinygltf::Accessor;

template <class Number> double read_number(const unsigned char* from, bool normalized) {
    Number x;
    std::memcpy(&x, from, sizeof x);
    if (!normalized || std::is_floating_point_v<Number>)
        return static_cast<double>(x);
    return std::max(-1.0, static_cast<double>(x) /
                              static_cast<double>(std::numeric_limits<Number>::max()));
}

double read_component(const unsigned char* from, int type, bool normalized) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return read_number<std::int8_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return read_number<std::uint8_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return read_number<std::int16_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return read_number<std::uint16_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return read_number<std::uint32_t>(from, normalized);
    default:
        return read_number<float>(from, false);
    }
}

std::uint64_t component_bytes(int type) {
    const int bytes = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type));
    return bytes > 0 && bytes <= 4 ? static_cast<std::uint64_t>(bytes) : 0;
}

// Elements of numbers in a bufferView.
struct Elements {
    int view;
    std::uint64_t offset; // from the start of the view, in bytes
    std::size_t count;
    int components, type; // of each element, of each component
    bool normalized;
};

// Calls put(element, component, number) for every number.
template <class Put>
Status read_elements(const tinygltf::Model& file, const Elements& e, const std::string& who,
                     const Put& put) {
    TESSERA_TRY_ASSIGN(const auto data, view_bytes(file, e.view, who));
    const std::uint64_t component = component_bytes(e.type);
    const std::uint64_t element = static_cast<std::uint64_t>(e.components) * component;
    std::uint64_t stride = at(file.bufferViews, e.view).byteStride;
    stride = stride == 0 ? element : stride;
    if (e.count != 0 && (e.offset > data.size() || stride < element || stride > 4096 ||
                         (e.count - 1) * stride + element > data.size() - e.offset))
        return invalid_gltf(who + " reaches beyond its bufferView");
    for (std::size_t i = 0; i < e.count; ++i)
        for (int c = 0; c < e.components; ++c)
            put(i, c,
                read_component(data.data() + e.offset + i * stride +
                                   static_cast<std::uint64_t>(c) * component,
                               e.type, e.normalized));
    return {};
}

// Puts the elements that a sparse accessor replaces.
Status read_replaced(const tinygltf::Model& file, const Accessor& a, int components,
                     const std::string& who, const PutNumber& put) {
    if (a.sparse.count < 0 || static_cast<std::size_t>(a.sparse.count) > a.count)
        return invalid_gltf(who + " replaces more elements than it has");
    const auto count = static_cast<std::size_t>(a.sparse.count);
    const auto& indices = a.sparse.indices;
    const auto& values = a.sparse.values;
    if (component_bytes(indices.componentType) == 0 || indices.byteOffset < 0 ||
        values.byteOffset < 0)
        return invalid_gltf(who + " has wrong sparse indices");
    std::vector<std::size_t> which(count, a.count);
    TESSERA_TRY(read_elements(file,
                              {.view = indices.bufferView,
                               .offset = static_cast<std::uint64_t>(indices.byteOffset),
                               .count = count,
                               .components = 1,
                               .type = indices.componentType,
                               .normalized = false},
                              who, [&](std::size_t i, int, double x) {
                                  if (x >= 0 && x < static_cast<double>(a.count))
                                      which[i] = static_cast<std::size_t>(x);
                              }));
    for (std::size_t i = 0; i < count; ++i)
        if (which[i] == a.count)
            return invalid_gltf(who + " replaces an element that it does not have");
    return read_elements(file,
                         {.view = values.bufferView,
                          .offset = static_cast<std::uint64_t>(values.byteOffset),
                          .count = count,
                          .components = components,
                          .type = a.componentType,
                          .normalized = a.normalized},
                         who, [&](std::size_t i, int c, double x) { put(which[i], c, x); });
}

} // namespace

Result<std::span<const unsigned char>> view_bytes(const tinygltf::Model& file, int index,
                                                  const std::string& who) {
    if (!has(file.bufferViews, index))
        return invalid_gltf(who + " has no bufferView");
    const tinygltf::BufferView& view = at(file.bufferViews, index);
    if (!has(file.buffers, view.buffer))
        return invalid_gltf("bufferView " + std::to_string(index) + " has no buffer");
    const auto& data = at(file.buffers, view.buffer).data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        return invalid_gltf("bufferView " + std::to_string(index) + " lies outside its buffer");
    return std::span(data).subspan(view.byteOffset, view.byteLength);
}

Result<std::size_t> read_accessor(const tinygltf::Model& file, int index, int least, int most,
                                  const PutNumber& put) {
    const std::string who = "accessor " + std::to_string(index);
    if (!has(file.accessors, index))
        return invalid_gltf(who + " does not exist");
    const Accessor& a = at(file.accessors, index);
    const int n = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
    if (n < least || n > most || component_bytes(a.componentType) == 0)
        return invalid_gltf(who + " has the wrong type");
    if (a.count > most_vertices)
        return Status(ErrorCode::unsupported,
                      who + " has more than " + std::to_string(most_vertices) + " elements");
    if (a.bufferView >= 0)
        TESSERA_TRY(read_elements(file,
                                  {.view = a.bufferView,
                                   .offset = a.byteOffset,
                                   .count = a.count,
                                   .components = n,
                                   .type = a.componentType,
                                   .normalized = a.normalized},
                                  who, put));
    else
        for (std::size_t i = 0; i < a.count; ++i)
            for (int c = 0; c < n; ++c)
                put(i, c, 0.0);
    if (a.sparse.isSparse)
        TESSERA_TRY(read_replaced(file, a, n, who, put));
    return a.count;
}

} // namespace tessera::corpus
