// Tests the requirements on a device.
#include "decoder_glsl/gl/gl_device.h"

#include <gtest/gtest.h>
#include <string>

namespace tessera::test {
namespace {

TEST(GlDevice, NamesEveryMissingFeature) {
    const DeviceLimits needed;
    EXPECT_TRUE(check_limits(needed, needed));
    DeviceLimits offered;
    offered.version = 43;
    offered.storage_block_bytes = needed.storage_block_bytes - 1;
    offered.group_count_y = 100;
    const Status status = check_limits(offered, needed);
    EXPECT_EQ(status.code(), ErrorCode::unsupported);
    EXPECT_EQ(status.message(),
              "OpenGL 4.5 is needed, this device offers 4.3; "
              "GL_MAX_COMPUTE_WORK_GROUP_COUNT[1] of 65535 is needed, this device offers 100; "
              "GL_MAX_SHADER_STORAGE_BLOCK_SIZE of 134217728 is needed, this device offers "
              "134217727");
    offered = {};
    offered.storage_block_bytes = std::int64_t{1} << 40;
    EXPECT_TRUE(check_limits(offered, needed));
}

TEST(GlDevice, ChecksEachLimit) {
    const std::pair<std::int64_t DeviceLimits::*, const char*> limits[] = {
        {&DeviceLimits::version, "OpenGL 4.5"},
        {&DeviceLimits::group_invocations, "GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS"},
        {&DeviceLimits::group_size_x, "GL_MAX_COMPUTE_WORK_GROUP_SIZE[0]"},
        {&DeviceLimits::group_count_x, "GL_MAX_COMPUTE_WORK_GROUP_COUNT[0]"},
        {&DeviceLimits::group_count_y, "GL_MAX_COMPUTE_WORK_GROUP_COUNT[1]"},
        {&DeviceLimits::group_count_z, "GL_MAX_COMPUTE_WORK_GROUP_COUNT[2]"},
        {&DeviceLimits::shared_bytes, "GL_MAX_COMPUTE_SHARED_MEMORY_SIZE"},
        {&DeviceLimits::storage_block_bytes, "GL_MAX_SHADER_STORAGE_BLOCK_SIZE"},
        {&DeviceLimits::compute_storage_blocks, "GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS"},
        {&DeviceLimits::combined_storage_blocks, "GL_MAX_COMBINED_SHADER_STORAGE_BLOCKS"},
        {&DeviceLimits::storage_bindings, "GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS"},
        {&DeviceLimits::compute_images, "GL_MAX_COMPUTE_IMAGE_UNIFORMS"},
        {&DeviceLimits::image_units, "GL_MAX_IMAGE_UNITS"},
        {&DeviceLimits::texture_size, "GL_MAX_TEXTURE_SIZE"},
        {&DeviceLimits::texture_layers, "GL_MAX_ARRAY_TEXTURE_LAYERS"}};
    EXPECT_EQ(sizeof(DeviceLimits), std::size(limits) * sizeof(std::int64_t));
    for (const auto& [member, name] : limits) {
        DeviceLimits offered;
        --(offered.*member);
        const Status status = check_limits(offered, DeviceLimits());
        EXPECT_EQ(status.message().find(name), 0u) << status.message();
        EXPECT_EQ(status.message().find(';'), std::string::npos) << status.message();
    }
}

} // namespace
} // namespace tessera::test
