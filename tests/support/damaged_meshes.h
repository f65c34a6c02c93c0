// Damage to the content of section `prxy`, for tests of every kind of it.
#pragma once

#include "format/surface_mesh.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>
#include <limits>

namespace tessera::test {

inline constexpr std::uint64_t no_memory_limit = std::numeric_limits<std::uint64_t>::max();

// Every shorter section and one with another byte must be refused.
inline void refuses_other_lengths(const Bytes& whole) {
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_EQ(decode_mesh(std::span(whole).first(size), no_memory_limit).status().code(),
                  ErrorCode::invalid_file)
            << size;
    Bytes more = whole;
    more.push_back(std::byte{0});
    EXPECT_EQ(decode_mesh(more, no_memory_limit).status().code(), ErrorCode::invalid_file);
}

// With any bit flipped, the result must be an error or a mesh within the limits.
inline void survives_flipped_bits(const Bytes& whole) {
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        Bytes flipped = whole;
        flipped[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
        const auto mesh = decode_mesh(flipped, 64u << 20);
        if (!mesh) {
            EXPECT_NE(mesh.status().code(), ErrorCode::runtime) << bit;
            continue;
        }
        ASSERT_EQ(mesh->normals.size(), mesh->positions.size());
        for (const auto& triangle : mesh->triangles)
            for (const std::uint32_t corner : triangle)
                ASSERT_LT(corner, mesh->positions.size());
        for (const glm::vec2& uv : mesh->uv)
            ASSERT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1) << bit;
    }
}

} // namespace tessera::test
