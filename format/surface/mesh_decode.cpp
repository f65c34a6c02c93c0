#include "format/io/bytes.h"
#include "format/surface/chart_tables.h"
#include "format/surface/mesh_check.h"

#include <algorithm>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/mesh/mesh.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tessera {
namespace {

constexpr std::string_view draco_name = "DRACO";
constexpr std::size_t fixed_bytes = 12; // of a header, up to and including the kind of traversal
// Memory that decoding takes, measured on unconnected triangles with normals, which take the most.
constexpr std::uint64_t bytes_per_triangle = 1000;
constexpr std::uint64_t bytes_of_tables = 16u << 20; // symbols, independent of the triangles
constexpr unsigned most_seam_tables = 2;             // for uv and normals; positions have none

using Attribute = draco::GeometryAttribute;

Status invalid_mesh(const std::string& text) {
    return {ErrorCode::invalid_file, "the mesh's stream " + text};
}

// Reads a number of seven bits per byte, the lowest first. The highest bit of a byte tells whether
// another byte follows.
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

// The counts that a stream claims. They are read first, before memory is allocated for the mesh.
struct DracoHeader {
    std::uint32_t vertices = 0, triangles = 0; // vertices are counted before seams split them
};

Result<DracoHeader> read_draco_header(std::span<const std::byte> stream) {
    if (stream.size() < fixed_bytes)
        return invalid_mesh("is cut off");
    const auto name = std::as_bytes(std::span(draco_name));
    if (!std::ranges::equal(stream.first(name.size()), name))
        return invalid_mesh("is not a Draco stream");
    const auto byte = [&](std::size_t at) { return std::to_integer<unsigned>(stream[at]); };
    if (byte(5) != 2 || byte(6) != 2)
        return invalid_mesh("has Draco version " + std::to_string(byte(5)) + "." +
                            std::to_string(byte(6)) + ", not 2.2");
    if (byte(7) != 1 || byte(8) != 1)
        return invalid_mesh("is not a mesh coded by Edgebreaker");
    if (load_le<std::uint16_t>(stream.data() + 9) != 0)
        return invalid_mesh("has metadata or unknown flags");
    if (byte(11) != 0 && byte(11) != 2)
        return invalid_mesh("has an unknown kind of traversal");

    std::span<const std::byte> rest = stream.subspan(fixed_bytes);
    DracoHeader header;
    if (!take_varint(rest, header.vertices) || !take_varint(rest, header.triangles) || rest.empty())
        return invalid_mesh("is cut off");
    if (header.triangles == 0)
        return invalid_mesh("has no triangles");
    if (header.triangles > max_mesh_triangles || header.vertices > 3 * header.triangles)
        return invalid_mesh("claims " + std::to_string(header.triangles) + " triangles and " +
                            std::to_string(header.vertices) + " vertices");
    if (std::to_integer<unsigned>(rest.front()) > most_seam_tables)
        return invalid_mesh("claims seams of more than uv and normals");
    return header;
}

// Bytes of memory that decoding may take, whatever the rest of the stream claims.
std::uint64_t decoding_bytes(const DracoHeader& header) {
    return std::uint64_t{header.triangles} * bytes_per_triangle + bytes_of_tables;
}

// Whether the attributes are positions, uv if asked for, and at most one set of normals, all of them
// floats with the right number of components.
bool has_expected_attributes(const draco::PointCloud& cloud, bool with_uv) {
    int positions = 0, uvs = 0, normals = 0;
    for (int i = 0; i < cloud.num_attributes(); ++i) {
        const draco::PointAttribute& a = *cloud.attribute(i);
        const bool uv = a.attribute_type() == Attribute::TEX_COORD;
        if (a.data_type() != draco::DT_FLOAT32 || a.num_components() != (uv ? 2 : 3))
            return false;
        positions += a.attribute_type() == Attribute::POSITION;
        normals += a.attribute_type() == Attribute::NORMAL;
        uvs += uv;
    }
    return positions == 1 && uvs == (with_uv ? 1 : 0) && normals <= 1 &&
           cloud.num_attributes() == positions + uvs + normals;
}

// Checks the kinds of the attributes before memory is allocated for their values. A stream can
// claim any number of attributes with up to 255 components per vertex.
class MeshDecoder : public draco::MeshEdgebreakerDecoder {
public:
    explicit MeshDecoder(bool with_uv) : with_uv_(with_uv) {}
    bool kinds_are_wrong = false;

protected:
    bool DecodeAllAttributes() override {
        kinds_are_wrong = !has_expected_attributes(*point_cloud(), with_uv_);
        return !kinds_are_wrong && draco::MeshEdgebreakerDecoder::DecodeAllAttributes();
    }

private:
    bool with_uv_;
};

template <class Value> std::vector<Value> values_of(const draco::Mesh& mesh, Attribute::Type type) {
    const draco::PointAttribute* const attribute = mesh.GetNamedAttribute(type);
    std::vector<Value> values;
    if (attribute == nullptr)
        return values;
    values.resize(mesh.num_points(), Value{0.0f});
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
        const draco::AttributeValueIndex at = attribute->mapped_index(draco::PointIndex(i));
        if (at.value() < attribute->size())
            attribute->GetValue(at, &values[i][0]);
    }
    return values;
}

SurfaceMesh copy_of(const draco::Mesh& mesh) {
    SurfaceMesh out;
    out.positions = values_of<glm::vec3>(mesh, Attribute::POSITION);
    out.normals = values_of<glm::vec3>(mesh, Attribute::NORMAL);
    out.uv = values_of<glm::vec2>(mesh, Attribute::TEX_COORD);
    out.triangles.reserve(mesh.num_faces());
    for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
        const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(i));
        out.triangles.push_back({face[0].value(), face[1].value(), face[2].value()});
    }
    return out;
}

Result<SurfaceMesh> decode_stream(std::span<const std::byte> stream, bool with_uv) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
    draco::Mesh mesh;
    MeshDecoder decoder(with_uv);
    const draco::DecoderOptions options;
    const draco::Status status = decoder.Decode(options, &buffer, &mesh);
    if (decoder.kinds_are_wrong)
        return invalid_mesh(with_uv
                                ? "must hold positions, uv and optionally normals, and nothing else"
                                : "must hold positions and optionally normals, and nothing else");
    if (!status.ok())
        return invalid_mesh("is damaged");
    if (buffer.remaining_size() != 0)
        return invalid_mesh("is followed by " + std::to_string(buffer.remaining_size()) + " bytes");
    return copy_of(mesh);
}

// The mesh of a Draco stream, with the normals of the stream, if any.
Result<SurfaceMesh> decode_draco(std::span<const std::byte> stream, bool with_uv,
                                 std::uint64_t most_bytes) {
    TESSERA_TRY_ASSIGN(const DracoHeader header, read_draco_header(stream));
    if (const std::uint64_t needed = decoding_bytes(header); needed > most_bytes)
        return Status{ErrorCode::unsupported, "the mesh of " + std::to_string(header.triangles) +
                                                  " triangles may take " + std::to_string(needed) +
                                                  " bytes of memory, more than " +
                                                  std::to_string(most_bytes)};
    TESSERA_TRY_ASSIGN(SurfaceMesh mesh, decode_stream(stream, with_uv));
    if (mesh.triangles.size() != header.triangles)
        return invalid_mesh("has " + std::to_string(mesh.triangles.size()) +
                            " triangles and claims " + std::to_string(header.triangles));
    TESSERA_TRY(check_mesh(mesh, with_uv, !mesh.normals.empty(), ErrorCode::invalid_file));
    for (glm::vec2& uv : mesh.uv)
        uv = glm::clamp(uv, 0.0f, 1.0f);
    for (glm::vec3& normal : mesh.normals)
        normal = glm::vec3(glm::normalize(glm::dvec3(normal)));
    return mesh;
}

// Calls decode(), and turns what it throws into errors.
template <class Decode> Result<SurfaceMesh> without_exceptions(const Decode& decode) {
    try {
        return decode();
    } catch (const std::bad_alloc&) {
        return Status{ErrorCode::runtime, "out of memory while decoding the mesh"};
    } catch (const std::length_error&) {
        return invalid_mesh("claims more than memory can hold");
    }
}

} // namespace

Result<SurfaceMesh> decode_shape(std::span<const std::byte> shape, std::uint64_t most_bytes) {
    return without_exceptions([&] { return decode_draco(shape, false, most_bytes); });
}

Result<SurfaceMesh> decode_mesh(std::span<const std::byte> stream, std::uint64_t most_bytes,
                                MeshCharts* charts) {
    return without_exceptions([&]() -> Result<SurfaceMesh> {
        SurfaceMesh mesh;
        if (has_chart_tables(stream)) {
            TESSERA_TRY_ASSIGN(const ChartedStream parts, split_charted(stream));
            TESSERA_TRY_ASSIGN(mesh, decode_draco(parts.shape, false, most_bytes));
            TESSERA_TRY_ASSIGN(MeshCharts read, read_chart_tables(parts, mesh));
            TESSERA_TRY(lay_charts(mesh, read));
            if (charts != nullptr)
                *charts = std::move(read);
        } else {
            TESSERA_TRY_ASSIGN(mesh, decode_draco(stream, true, most_bytes));
        }
        if (mesh.normals.empty())
            mesh.normals = mesh_normals(mesh);
        return mesh;
    });
}

} // namespace tessera
