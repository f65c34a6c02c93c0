#include "tools/scenes/mesh_placement.h"

#include "tools/support/parse.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

constexpr double least_radius = 1e-3, most_radius = 1e5;
// Rounding to single precision there is far below the step between quantised positions.
constexpr double most_radii_away = 64;

// Read back without loss.
std::string exact(const glm::dvec3& v) {
    return format_digits(v.x, 17) + "," + format_digits(v.y, 17) + "," + format_digits(v.z, 17);
}

} // namespace

MeshPlacement placement_of(const corpus::ModelFrame& frame) {
    MeshPlacement placement;
    const double radius = corpus::paper_radius / frame.scale;
    if (radius < least_radius || radius > most_radius)
        placement.scale = frame.scale;
    if (glm::length(frame.middle) > most_radii_away * radius)
        placement.offset = -placement.scale * frame.middle;
    return placement;
}

corpus::ModelFrame frame_of_mesh(const corpus::ModelFrame& frame, const MeshPlacement& placement) {
    return {placement.scale * frame.middle + placement.offset, frame.scale / placement.scale};
}

std::vector<std::pair<std::string, std::string>> facts_of(const MeshPlacement& placement) {
    return {{"mesh scale", format_digits(placement.scale, 17)},
            {"mesh offset", exact(placement.offset)}};
}

Result<corpus::ModelFrame> frame_of_mesh(const corpus::ModelFrame& frame,
                                         const Metadata& metadata) {
    const auto scale = metadata.find("Mesh scale"), offset = metadata.find("Mesh offset");
    if (scale == metadata.end() && offset == metadata.end())
        return corpus::ModelFrame(); // an older file, whose mesh is where the baker works
    MeshPlacement placement;
    if (scale == metadata.end() || offset == metadata.end() ||
        !parse_number(scale->second, placement.scale) || !std::isfinite(placement.scale) ||
        !(placement.scale > 0.0) || !parse_point(offset->second, placement.offset).ok())
        return Status(ErrorCode::invalid_file,
                      "the metadata keys Mesh scale and Mesh offset are not one positive number "
                      "and three numbers");
    return frame_of_mesh(frame, placement);
}

std::string placement_note(const MeshPlacement& placement) {
    if (!placement.moves())
        return "";
    std::string note;
    if (placement.scale != 1.0)
        note = "the model is scaled by " + format_digits(placement.scale, 6);
    if (placement.offset != glm::dvec3(0.0))
        note += std::string(note.empty() ? "the model is" : " and") + " moved to the origin";
    return note + ", because its size or place cannot be expressed precisely";
}

} // namespace tessera
