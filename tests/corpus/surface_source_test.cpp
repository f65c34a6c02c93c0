// Tests that texels on a scene's own surfaces hold the scene's light, for any division into boxes.
#include "corpus/intersect.h"
#include "corpus/surface/angular_choice.h"
#include "tests/support/baked_surfaces.h"
#include "tests/support/corpus_support.h"

#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

using namespace support;

constexpr Texels2 few{6, 5};

std::unique_ptr<TexelSource> source_of(const std::shared_ptr<const LitSurface>& lit, AngularMap map,
                                       unsigned samples) {
    auto source = make_surface_source(lit, map, few, samples);
    EXPECT_TRUE(source.ok()) << source.status().message();
    return std::move(*source);
}

Box4 one_texel(const Extent4& place) {
    return {place, {place[0] + 1, place[1] + 1, place[2] + 1, place[3] + 1}};
}

TEST(SurfaceSource, SameBytesForAnyBoxPartition) {
    for (const char* name : {"composed", "mirror", "lamps", "lambert"}) {
        const Scene scene = surfaces_of(name);
        const auto lit = lit_surface(scene, surface_of(scene, 2, {8, 8}));
        for (const AngularMap map :
             {AngularMap::octahedral_hemisphere, AngularMap::octahedral_mirrored}) {
            const auto source = source_of(lit, map, 2);
            const auto mask = make_surface_mask(lit, map, few);
            for (TexelSource* texels : {source.get(), mask.get()}) {
                const TextureDesc& desc = texels->desc();
                const Bytes whole = read_box(*texels, Box4::whole(desc.size));
                auto random = generator(6);
                for (int i = 0; i < 20; ++i) {
                    Box4 box;
                    for (std::size_t a = 0; a < 4; ++a) {
                        box.begin[a] = static_cast<std::uint32_t>(random() % desc.size[a]);
                        box.end[a] =
                            box.begin[a] + 1 +
                            static_cast<std::uint32_t>(random() % (desc.size[a] - box.begin[a]));
                    }
                    ASSERT_TRUE(read_box(*texels, box) == cut_out(whole, desc, box)) << name;
                }
            }
        }
    }
}

// A ray from just above the true surface back along the texel's direction meets the same point.
TEST(SurfaceSource, TexelsHoldTheLightOfTheScene) {
    for (const SceneInfo& info : scenes()) {
        const Scene scene = surfaces_of(info.name);
        const auto lit = lit_surface(scene, surface_of(scene, 4, {8, 8}));
        const TexelPlaces& places = lit->places();
        for (const AngularMap map :
             {AngularMap::octahedral_hemisphere, AngularMap::octahedral_mirrored}) {
            const auto source = source_of(lit, map, 1);
            auto random = generator(3);
            int compared = 0;
            for (int i = 0; i < 600; ++i) {
                Extent4 place;
                for (std::size_t a = 0; a < 4; ++a)
                    place[a] = static_cast<std::uint32_t>(random() % source->desc().size[a]);
                if (!places.matters(place[0], place[1]))
                    continue;
                const auto at = lit->at(place[0], place[1], {0, 0});
                const glm::dvec3 d = octahedral_direction(map, at.frame, (place[2] + 0.5) / few[0],
                                                          (place[3] + 0.5) / few[1]);
                const Object& object = lit->object_of(lit->chart_at(place[0], place[1]));
                const Ray ray{at.light.position() + 1e-5 * d, -d};
                const Hit hit =
                    nearest_hit(lit->scene(), ray, every_object >> (64 - scene.objects.size()));
                if (glm::dot(d, at.light.normal()) < 0.1 || hit.object != &object ||
                    hit.distance > 2e-5)
                    continue; // below the surface, in the air of a gutter, or inside another object
                const glm::dvec3 seen = trace(scene, ray);
                const auto texel = values_of(read_box(*source, one_texel(place)), info.type);
                for (glm::length_t c = 0; c < 3; ++c) {
                    const double scale = info.type == SampleType::unorm8 ? 1.0 : seen[c] + 1e-3;
                    EXPECT_NEAR(texel[static_cast<std::size_t>(c)], seen[c], scale / 250)
                        << info.name << ' ' << to_string(place);
                }
                ++compared;
            }
            EXPECT_GT(compared, 50) << info.name;
        }
    }
}

// Below the surface the mirrored map holds the mirror image of what is above.
TEST(SurfaceSource, LightIsMirroredBelowTheSurface) {
    const Scene scene = surfaces_of("mirror");
    const LitPlace place(scene, scene.objects[0], {0, 1.2, 0}, {0, 1, 0});
    const glm::dvec3 d = glm::normalize(glm::dvec3{0.5, 0.2, -0.7});
    EXPECT_EQ(place.leaving(d), place.leaving({d.x, -d.y, d.z}));
}

TEST(SurfaceSource, MasksHiddenTexels) {
    Scene scene;
    scene.objects = {sphere({0, 0, 0}, 1, {}), box({0, 0, 0}, {0.5, 0.5, 0.5}, {}),
                     plane({0, -1.5, 0}, 2, 2, {})};
    const auto lit = lit_surface(scene, surface_of(scene, 16));
    const auto mask = make_surface_mask(lit, AngularMap::octahedral_mirrored, {16, 16});
    const Extent4 size = mask->desc().size;
    const Bytes all = read_box(*mask, Box4::whole(size));
    std::array<std::size_t, 3> seen{}, texels{};
    std::size_t next = 0;
    for (std::uint32_t v = 0; v < size[1]; ++v)
        for (std::uint32_t u = 0; u < size[0]; ++u) {
            const bool inside = lit->places().matters(u, v);
            const std::size_t object = inside ? lit->chart_at(u, v).object : 0;
            for (int i = 0; i < 256; ++i) {
                const bool matters = all[next++] != std::byte{0};
                ASSERT_TRUE(inside || !matters);
                seen[object] += matters;
                texels[object] += inside;
            }
        }
    EXPECT_EQ(seen[1], 0u); // the box is inside the sphere
    for (const std::size_t object :
         {0u, 2u}) { // half of the directions, and the taps at the border
        EXPECT_GT(seen[object], texels[object] / 2);
        EXPECT_LT(seen[object], texels[object] * 8 / 10);
    }
    const auto hemisphere = make_surface_mask(lit, AngularMap::octahedral_hemisphere, {16, 16});
    EXPECT_EQ(hemisphere->desc().size, (Extent4{size[0], size[1], 1, 1}));
}

TEST(SurfaceSource, ChoosesAngularMaps) {
    const Texels2 directions{16, 16};
    for (const auto& [name, map] : {std::pair("composed", AngularMap::octahedral_mirrored),
                                    std::pair("mirror", AngularMap::octahedral_hemisphere),
                                    std::pair("gallery", AngularMap::octahedral_hemisphere)}) {
        const Scene scene = surfaces_of(name);
        const auto lit = lit_surface(scene, surface_of(scene, 16));
        EXPECT_EQ(choose_angular_map(*lit, directions), map) << name;
    }
}

TEST(SurfaceSource, RefusesBadArguments) {
    const Scene scene = surfaces_of("aliasing-near");
    const auto lit = lit_surface(scene, surface_of(scene, 2, {8, 8}));
    const AngularMap map = AngularMap::octahedral_hemisphere;
    EXPECT_EQ(make_surface_source(lit, map, few, 0).status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(make_surface_source(lit, map, {0, 1}, 1).status().code(), ErrorCode::bad_argument);
    Bytes none;
    EXPECT_EQ(source_of(lit, map, 1)->read(Box4{}, none).code(), ErrorCode::bad_argument);
}

} // namespace
} // namespace tessera::corpus
