#include "corpus/trace/ray_scene.h"

#include <algorithm>
#include <embree3/rtcore.h>

namespace tessera::corpus {
namespace {

// Embree's normal belongs to counter-clockwise corners, so that of a back points along the ray.
bool is_back(const RTCRay& ray, const RTCHit& hit) {
    return hit.Ng_x * ray.dir_x + hit.Ng_y * ray.dir_y + hit.Ng_z * ray.dir_z >= 0;
}

glm::dvec2 barycentric_of(const RTCHit& hit) {
    return {static_cast<double>(hit.u), static_cast<double>(hit.v)};
}

void let_pass(const RTCFilterFunctionNArguments* arguments) {
    const RTCHit& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
    const auto& passes = *static_cast<const RayScene::Passes*>(arguments->geometryUserPtr);
    if (is_back(*reinterpret_cast<const RTCRay*>(arguments->ray), hit) ||
        (passes && passes(hit.primID, barycentric_of(hit))))
        arguments->valid[0] = 0;
}

RTCRay make_ray(const glm::dvec3& origin, const glm::dvec3& direction) {
    RTCRay ray{};
    ray.org_x = static_cast<float>(origin.x);
    ray.org_y = static_cast<float>(origin.y);
    ray.org_z = static_cast<float>(origin.z);
    ray.dir_x = static_cast<float>(direction.x);
    ray.dir_y = static_cast<float>(direction.y);
    ray.dir_z = static_cast<float>(direction.z);
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = ~0u;
    return ray;
}

} // namespace

// On the heap, because Embree keeps the address of `passes`.
struct RayScene::State {
    Passes passes;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    ~State() {
        if (scene)
            rtcReleaseScene(scene);
        if (device)
            rtcReleaseDevice(device);
    }
};

RayScene::RayScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

Result<RayScene> RayScene::make(std::span<const glm::vec3> positions,
                                std::span<const std::array<std::uint32_t, 3>> triangles,
                                bool fronts_only, Passes passes) {
    auto state = std::make_unique<State>();
    state->passes = std::move(passes);
    state->device = rtcNewDevice("threads=1"); // callers have their own threads
    const auto failed = [&] {
        const int error = static_cast<int>(rtcGetDeviceError(state->device));
        return Status(ErrorCode::runtime, "Embree: error " + std::to_string(error));
    };
    if (!state->device)
        return failed();
    RTCGeometry geometry = rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            sizeof(glm::vec3), positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof triangles[0], triangles.size());
    if (!corners || !indices) {
        rtcReleaseGeometry(geometry);
        return failed();
    }
    std::ranges::copy(positions, static_cast<glm::vec3*>(corners));
    std::ranges::copy(triangles, static_cast<std::array<std::uint32_t, 3>*>(indices));
    if (fronts_only) {
        rtcSetGeometryUserData(geometry, &state->passes);
        rtcSetGeometryIntersectFilterFunction(geometry, let_pass);
        rtcSetGeometryOccludedFilterFunction(geometry, let_pass);
    }
    rtcCommitGeometry(geometry);
    state->scene = rtcNewScene(state->device);
    rtcSetSceneFlags(state->scene, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(state->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(state->scene);
    if (rtcGetDeviceError(state->device) != RTC_ERROR_NONE)
        return failed();
    return RayScene(std::move(state));
}

std::optional<RayHit> RayScene::first_hit(const glm::dvec3& origin,
                                          const glm::dvec3& direction) const {
    RTCRayHit query{make_ray(origin, direction), {}};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(state_->scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return std::nullopt;
    return RayHit{query.hit.primID, barycentric_of(query.hit), static_cast<double>(query.ray.tfar),
                  is_back(query.ray, query.hit)};
}

bool RayScene::is_blocked(const glm::dvec3& origin, const glm::dvec3& direction,
                          double reach) const {
    RTCRay ray = make_ray(origin, direction);
    ray.tfar = static_cast<float>(reach);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(state_->scene, &context, &ray);
    return ray.tfar < 0;
}

} // namespace tessera::corpus
