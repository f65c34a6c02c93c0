// The charts of a mesh whose uv are projections of its positions (FORMAT.md 5.2).
#pragma once

#include "format/surface_mesh.h"

namespace tessera {

// Whether section `prxy` has tables of charts. Otherwise it is a Draco stream.
bool has_chart_tables(std::span<const std::byte> section);

// The parts of a section with tables of charts.
struct ChartedStream {
    std::array<std::uint32_t, 2> size{0, 0}; // of the atlas, in texels
    float density = 0;                       // texels per world unit
    std::uint32_t charts = 0;
    // Of symbols, by the kind of a triangle's neighbourhood, and of the distances between charts.
    static constexpr std::size_t context_count = 4;
    std::array<std::uint32_t, context_count + 1> counts{};
    std::span<const std::byte> shape, tables;
};

// Error: invalid_file.
Result<ChartedStream> split_charted(std::span<const std::byte> section);

// The charts of the triangles of `mesh`, the decoded shape. Error: invalid_file.
Result<MeshCharts> read_chart_tables(const ChartedStream& stream, const SurfaceMesh& mesh);

// Gives the mesh the uv of its charts. Vertices on borders between charts are duplicated. Error:
// invalid_file, if a chart leaves the atlas.
Status lay_charts(SurfaceMesh& mesh, const MeshCharts& charts);

} // namespace tessera
