// Corpus scenes whose objects are textured on their own surfaces.
#pragma once

#include "corpus/catalog.h"
#include "corpus/surface/scene_surface.h"
#include "corpus/surface/surface_source.h"

#include <gtest/gtest.h>

namespace tessera::corpus::support {

inline Scene surfaces_of(const std::string& name) {
    return with_surfaces(*make_scene(name));
}

inline SceneSurface surface_of(const Scene& scene, double density, const Texels2& tile = {32, 32}) {
    SurfaceOptions options;
    options.atlas.density = density;
    options.atlas.tile = tile;
    auto surface = make_scene_surface(scene, options);
    EXPECT_TRUE(surface.ok()) << surface.status().message();
    return std::move(*surface);
}

// Encodes and decodes the mesh first, so that positions are quantised as viewers get them.
inline std::shared_ptr<const LitSurface> lit_surface(const Scene& scene,
                                                     const SceneSurface& surface) {
    const auto stream = encode_mesh(surface.mesh, MeshQuantisation{});
    EXPECT_TRUE(stream.ok()) << stream.status().message();
    auto mesh = decode_mesh(*stream, 1u << 28);
    EXPECT_TRUE(mesh.ok()) << mesh.status().message();
    auto lit = LitSurface::make(scene, std::move(*mesh), surface.charts, surface.size);
    EXPECT_TRUE(lit.ok()) << lit.status().message();
    return *lit;
}

} // namespace tessera::corpus::support
