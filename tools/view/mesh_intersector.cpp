#include "tools/view/mesh_intersector.h"

#include <embree3/rtcore.h>

#include <cstring>
#include <limits>

namespace tessera {
namespace {

// Embree's normal is that of counter-clockwise corners: a back's points along with the ray.
void pass_backs(const RTCFilterFunctionNArguments* arguments) {
    const RTCRay& ray = *reinterpret_cast<const RTCRay*>(arguments->ray);
    const RTCHit& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
    if (hit.Ng_x * ray.dir_x + hit.Ng_y * ray.dir_y + hit.Ng_z * ray.dir_z >= 0)
        arguments->valid[0] = 0;
}

} // namespace

struct MeshIntersector::State {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    ~State() {
        if (scene)
            rtcReleaseScene(scene);
        if (device)
            rtcReleaseDevice(device);
    }
};

MeshIntersector::MeshIntersector(std::unique_ptr<State> state) : state_(std::move(state)) {}
MeshIntersector::MeshIntersector(MeshIntersector&&) noexcept = default;
MeshIntersector& MeshIntersector::operator=(MeshIntersector&&) noexcept = default;
MeshIntersector::~MeshIntersector() = default;

Result<MeshIntersector> MeshIntersector::create(const SurfaceMesh& mesh) {
    auto state = std::make_unique<State>();
    // The tool has threads of its own; a mesh for a viewer is built in a moment.
    state->device = rtcNewDevice("threads=1");
    const auto failed = [&] {
        return Status(ErrorCode::runtime,
                      "Embree: error " +
                          std::to_string(static_cast<int>(rtcGetDeviceError(state->device))));
    };
    if (!state->device)
        return failed();
    RTCGeometry geometry = rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* positions =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(glm::vec3), mesh.positions.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              sizeof mesh.triangles[0], mesh.triangles.size());
    if (!positions || !triangles) {
        rtcReleaseGeometry(geometry);
        return failed();
    }
    std::memcpy(positions, mesh.positions.data(), mesh.positions.size() * sizeof(glm::vec3));
    std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * sizeof mesh.triangles[0]);
    rtcSetGeometryIntersectFilterFunction(geometry, pass_backs);
    rtcCommitGeometry(geometry);
    state->scene = rtcNewScene(state->device);
    // No ray slips between two triangles that share an edge.
    rtcSetSceneFlags(state->scene, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(state->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(state->scene);
    if (rtcGetDeviceError(state->device) != RTC_ERROR_NONE)
        return failed();
    return MeshIntersector(std::move(state));
}

std::optional<MeshHit> MeshIntersector::first_hit(const glm::dvec3& origin,
                                                  const glm::dvec3& direction) const {
    RTCRayHit query{};
    RTCRay& ray = query.ray;
    ray.org_x = static_cast<float>(origin.x);
    ray.org_y = static_cast<float>(origin.y);
    ray.org_z = static_cast<float>(origin.z);
    ray.dir_x = static_cast<float>(direction.x);
    ray.dir_y = static_cast<float>(direction.y);
    ray.dir_z = static_cast<float>(direction.z);
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(state_->scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return std::nullopt;
    return MeshHit{query.hit.primID, {query.hit.u, query.hit.v}, ray.tfar};
}

} // namespace tessera
