#include "format/surface/draco_header.h"

#include "format/io/bytes.h"
#include "format/surface/mesh_check.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace tessera {
namespace {

constexpr std::string_view draco_name = "DRACO";
constexpr std::size_t fixed_bytes = 12; // up to and with the kind of traversal
// Measured: soup of single triangles with normals, three vertices each, takes the most.
constexpr std::uint64_t bytes_a_triangle = 1000;
constexpr std::uint64_t bytes_of_tables = 16u << 20; // of symbols, however few triangles there are
constexpr unsigned most_seam_tables = 2;             // of uv and of normals; positions need none

Status invalid_stream(const std::string& text) {
    return {ErrorCode::invalid_file, "the mesh's stream " + text};
}

// Seven bits a byte, lowest first; the highest bit says that more follow.
bool take_varint(std::span<const std::byte>& bytes, std::uint32_t& value) {
    value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
        if (bytes.empty())
            return false;
        const auto byte = std::to_integer<std::uint32_t>(bytes.front());
        bytes = bytes.subspan(1);
        if (shift == 28 && byte > 15)
            return false;
        value |= (byte & 127) << shift;
        if (byte < 128)
            return true;
    }
    return false;
}

} // namespace

Result<DracoHeader> read_draco_header(std::span<const std::byte> stream) {
    if (stream.size() < fixed_bytes)
        return invalid_stream("is cut off");
    const auto name = std::as_bytes(std::span(draco_name));
    if (!std::ranges::equal(stream.first(name.size()), name))
        return invalid_stream("is not Draco's");
    const auto byte = [&](std::size_t at) { return std::to_integer<unsigned>(stream[at]); };
    if (byte(5) != 2 || byte(6) != 2)
        return invalid_stream("has Draco's version " + std::to_string(byte(5)) + "." +
                              std::to_string(byte(6)) + ", not 2.2");
    if (byte(7) != 1 || byte(8) != 1)
        return invalid_stream("is not a mesh coded by Edgebreaker");
    if (load_le<std::uint16_t>(stream.data() + 9) != 0)
        return invalid_stream("has metadata or unknown flags");
    if (byte(11) != 0 && byte(11) != 2)
        return invalid_stream("has an unknown kind of traversal");

    std::span<const std::byte> rest = stream.subspan(fixed_bytes);
    DracoHeader header;
    if (!take_varint(rest, header.vertices) || !take_varint(rest, header.triangles) || rest.empty())
        return invalid_stream("is cut off");
    if (header.triangles == 0)
        return invalid_stream("has no triangles");
    if (header.triangles > max_mesh_triangles || header.vertices > 3 * header.triangles)
        return invalid_stream("claims " + std::to_string(header.triangles) + " triangles and " +
                              std::to_string(header.vertices) + " vertices");
    if (std::to_integer<unsigned>(rest.front()) > most_seam_tables)
        return invalid_stream("claims seams of more than uv and normals");
    return header;
}

std::uint64_t decoding_bytes(const DracoHeader& header) {
    return std::uint64_t{header.triangles} * bytes_a_triangle + bytes_of_tables;
}

} // namespace tessera
