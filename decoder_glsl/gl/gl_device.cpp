#include "decoder_glsl/gl/gl_device.h"

#include <epoxy/gl.h>

#include <string>

namespace tessera {
namespace {

constexpr int no_axis = -1;

struct Limit {
    const char* name;
    GLenum query;
    int axis;
    std::int64_t DeviceLimits::*member;
};

constexpr Limit limit_table[] = {
#define TESSERA_LIMIT(query, member)                                                               \
    { #query, query, no_axis, &DeviceLimits::member }
#define TESSERA_LIMIT_OF_AXIS(query, axis, member)                                                 \
    { #query "[" #axis "]", query, axis, &DeviceLimits::member }
    TESSERA_LIMIT(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, group_invocations),
    TESSERA_LIMIT_OF_AXIS(GL_MAX_COMPUTE_WORK_GROUP_SIZE, 0, group_size_x),
    TESSERA_LIMIT_OF_AXIS(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, group_count_x),
    TESSERA_LIMIT_OF_AXIS(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 1, group_count_y),
    TESSERA_LIMIT_OF_AXIS(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 2, group_count_z),
    TESSERA_LIMIT(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, shared_bytes),
    TESSERA_LIMIT(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, storage_block_bytes),
    TESSERA_LIMIT(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, compute_storage_blocks),
    TESSERA_LIMIT(GL_MAX_COMBINED_SHADER_STORAGE_BLOCKS, combined_storage_blocks),
    TESSERA_LIMIT(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, storage_bindings),
    TESSERA_LIMIT(GL_MAX_COMPUTE_IMAGE_UNIFORMS, compute_images),
    TESSERA_LIMIT(GL_MAX_IMAGE_UNITS, image_units),
    TESSERA_LIMIT(GL_MAX_TEXTURE_SIZE, texture_size),
    TESSERA_LIMIT(GL_MAX_ARRAY_TEXTURE_LAYERS, texture_layers),
#undef TESSERA_LIMIT
#undef TESSERA_LIMIT_OF_AXIS
};

std::string version_text(std::int64_t version) {
    return std::to_string(version / 10) + "." + std::to_string(version % 10);
}

} // namespace

Status check_limits(const DeviceLimits& offered, const DeviceLimits& needed) {
    std::string missing;
    if (offered.version < needed.version)
        missing = "OpenGL " + version_text(needed.version) + " is needed, this device offers " +
                  version_text(offered.version);
    for (const Limit& limit : limit_table)
        if (offered.*limit.member < needed.*limit.member)
            missing += (missing.empty() ? "" : "; ") + std::string(limit.name) + " of " +
                       std::to_string(needed.*limit.member) + " is needed, this device offers " +
                       std::to_string(offered.*limit.member);
    return missing.empty() ? Status() : Status(ErrorCode::unsupported, missing);
}

DeviceLimits current_limits() {
    DeviceLimits limits;
    limits.version = epoxy_is_desktop_gl() ? epoxy_gl_version() : 0;
    for (const Limit& limit : limit_table) {
        std::int64_t& value = limits.*limit.member = 0;
        if (limits.version < 43) // older versions know few of the names
            continue;
        if (limit.axis == no_axis) {
            GLint64 wide = 0; // block sizes can exceed 2^31
            glGetInteger64v(limit.query, &wide);
            value = wide;
        } else {
            GLint narrow = 0;
            glGetIntegeri_v(limit.query, static_cast<GLuint>(limit.axis), &narrow);
            value = narrow;
        }
    }
    return limits;
}

Status check_device() {
    return check_limits(current_limits(), DeviceLimits());
}

} // namespace tessera
