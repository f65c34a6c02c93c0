#include "corpus/bake.h"

#include "corpus/sampling.h"
#include "corpus/shade.h"
#include "corpus/texel_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <new>
#include <numbers>
#include <vector>

namespace tessera::corpus {
namespace {

// The objects that any ray of a texel can meet, for all directions (s, t) at one place (u, v).
//
// All rays of a texel start within `reach` of the place's centre and run within `spread` radians of
// the texel's central ray. They can meet a bounding sphere of radius r at distance D only if the
// central ray runs within spread + asin((r + reach) / D) of its centre. Since the direction of the
// centre is known in the place's frame, a texel needs one multiplication and one comparison.
class Culling {
public:
    Culling(const Scene& scene, const SphereWindow& window, const Sampler& sampler)
        : scene_(scene), window_(window),
          spread_(std::hypot(sampler.half_width(axis_s), sampler.half_width(axis_t)) +
                  std::hypot(sampler.half_width(axis_u), sampler.half_width(axis_v))),
          reach_(window.radius *
                 std::hypot(sampler.half_width(axis_u), sampler.half_width(axis_v))) {}

    // `alphas`: the angles of the texels along s.
    void move_to(const SinCos& longitude, const SinCos& latitude,
                 const std::vector<SinCos>& alphas) {
        always_ = 0;
        cones_.clear();
        across_.clear();
        for (std::size_t i = 0; i < scene_.objects.size(); ++i)
            add(scene_.objects[i], ObjectMask{1} << i, longitude, latitude, alphas);
    }

    // Writes the objects of each texel of one row along s. `beta` is the row's angle.
    void row(const SinCos& beta, std::vector<ObjectMask>& masks) const {
        std::fill(masks.begin(), masks.end(), always_);
        const double* across = across_.data();
        for (const Cone& cone : cones_) {
            const double least = cone.cosine - cone.up * beta.sin;
            for (std::size_t i = 0; i < masks.size(); ++i)
                masks[i] |= across[i] * beta.cos >= least ? cone.bit : 0;
            across += masks.size();
        }
    }

private:
    struct Cone {
        ObjectMask bit;
        double up;     // the part along ey of the direction to the object's centre
        double cosine; // of the largest angle at which a ray can hit the object
    };

    void add(const Object& object, ObjectMask bit, const SinCos& longitude, const SinCos& latitude,
             const std::vector<SinCos>& alphas) {
        const glm::dvec3 ez = place_normal(longitude, latitude);
        // From the object to the place, because rays run along -d.
        const glm::dvec3 way = window_.centre +
                               ez * (window_.inside ? -window_.radius : window_.radius) -
                               object.centre;
        const double distance = glm::length(way);
        const double radius = (object.bound + reach_) * (1.0 + 1e-9);
        const double angle =
            radius < distance ? std::asin(radius / distance) + spread_ + 1e-9 : std::numbers::pi;
        if (angle >= std::numbers::pi) {
            always_ |= bit;
            return;
        }
        const glm::dvec3 d = way / distance;
        const double outward = glm::dot(d, ez);
        const double side = d.x * longitude.cos - d.z * longitude.sin;
        const double up =
            d.y * latitude.cos - (d.x * longitude.sin + d.z * longitude.cos) * latitude.sin;
        cones_.push_back({bit, up, std::cos(angle)});
        for (const SinCos& alpha : alphas)
            across_.push_back(side * alpha.sin + outward * alpha.cos);
    }

    const Scene& scene_;
    const SphereWindow& window_;
    double spread_;
    double reach_;
    ObjectMask always_ = 0;
    std::vector<Cone> cones_;
    std::vector<double> across_; // for each cone and texel along s: the cosine's part from s
};

class BakedTexture final : public TexelSource {
public:
    BakedTexture(Scene scene, const SphereWindow& window, const TextureDesc& desc, unsigned samples,
                 std::uint64_t seed)
        : scene_(std::move(scene)), window_(window), desc_(desc),
          sampler_(desc.size, samples, seed), empty_(to_bytes(scene_.background, desc.type)) {}

    const TextureDesc& desc() const override { return desc_; }
    bool cheap_to_reread() const override { return false; }

    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        try {
            scene_.painted ? paint(box, out.data()) : bake(box, out.data());
        } catch (const std::bad_alloc&) {
            return {ErrorCode::runtime, "out of memory while baking " + to_string(box)};
        }
        return {};
    }

private:
    std::vector<SinCos> centres(int axis, const Box4& box) const {
        const auto a = static_cast<std::size_t>(axis);
        std::vector<SinCos> result;
        result.reserve(box.end[a] - box.begin[a]);
        for (std::uint32_t i = box.begin[a]; i < box.end[a]; ++i)
            result.push_back(sampler_.centre(axis, i));
        return result;
    }

    void bake(const Box4& box, std::byte* out) const {
        const std::vector<SinCos> alphas = centres(axis_s, box);
        const std::vector<SinCos> betas = centres(axis_t, box);
        std::vector<ObjectMask> masks(alphas.size());
        Culling culling(scene_, window_, sampler_);
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u) {
                // The frame of a window that is seen from inside is that of the opposite place.
                const double side = window_.inside ? -1.0 : 1.0;
                const SinCos at_u = sampler_.centre(axis_u, u), at_v = sampler_.centre(axis_v, v);
                const SinCos longitude{side * at_u.sin, side * at_u.cos};
                const SinCos latitude{side * at_v.sin, at_v.cos};
                culling.move_to(longitude, latitude, alphas);
                const std::uint64_t place = std::uint64_t{v} * desc_.size[axis_u] + u;
                for (std::size_t t = 0; t < betas.size(); ++t) {
                    culling.row(betas[t], masks);
                    const std::uint64_t first =
                        (place * desc_.size[axis_t] + box.begin[axis_t] + t) * desc_.size[axis_s] +
                        box.begin[axis_s];
                    out = bake_row(first, {longitude, latitude, SinCos{}, betas[t]}, alphas, masks,
                                   out);
                }
            }
    }

    std::byte* bake_row(std::uint64_t first_key, Angles centre, const std::vector<SinCos>& alphas,
                        const std::vector<ObjectMask>& masks, std::byte* out) const {
        const std::size_t bytes = desc_.texel_bytes();
        for (std::size_t s = 0; s < alphas.size(); ++s, out += bytes) {
            centre[axis_s] = alphas[s];
            const TexelBytes texel =
                masks[s] == 0 ? empty_
                              : to_bytes(mean_of_rays(first_key + s, centre, masks[s]), desc_.type);
            std::memcpy(out, texel.data(), bytes);
        }
        return out;
    }

    glm::dvec3 mean_of_rays(std::uint64_t key, const Angles& centre, ObjectMask mask) const {
        const Jitter rotation = sampler_.rotation(key);
        glm::dvec3 sum{0.0};
        for (unsigned i = 0; i < sampler_.count(); ++i)
            sum += trace(scene_, window_ray(window_, sampler_.angles(centre, i, rotation)), mask);
        return sum / static_cast<double>(sampler_.count());
    }

    // The samples depend only on the place, so that noise does not vary with the direction.
    void paint(const Box4& box, std::byte* out) const {
        const std::size_t bytes = desc_.texel_bytes();
        const Extent4 extent = box.extent();
        const std::uint64_t directions = std::uint64_t{extent[axis_s]} * extent[axis_t];
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u) {
                const Angles centre{sampler_.centre(axis_u, u), sampler_.centre(axis_v, v)};
                const Jitter rotation =
                    sampler_.rotation(std::uint64_t{v} * desc_.size[axis_u] + u);
                glm::dvec3 sum{0.0};
                for (unsigned i = 0; i < sampler_.count(); ++i) {
                    const Angles angles = sampler_.angles(centre, i, rotation);
                    sum += trace_paint(scene_, place_normal(angles[axis_u], angles[axis_v]));
                }
                const TexelBytes texel =
                    to_bytes(sum / static_cast<double>(sampler_.count()), desc_.type);
                for (std::uint64_t i = 0; i < directions; ++i, out += bytes)
                    std::memcpy(out, texel.data(), bytes);
            }
    }

    Scene scene_;
    SphereWindow window_;
    TextureDesc desc_;
    Sampler sampler_;
    TexelBytes empty_; // a texel whose rays meet no object
};

} // namespace

Result<std::unique_ptr<TexelSource>> make_baked_source(const std::string& name, const Extent4& size,
                                                       unsigned samples_per_texel,
                                                       std::uint64_t seed,
                                                       const SphereWindow& window) {
    TESSERA_TRY_ASSIGN(Scene scene, make_scene(name));
    if (scene.painted && window.inside)
        return Status{ErrorCode::bad_argument,
                      name + " is a painted sphere; it can only be seen from outside"};
    if (samples_per_texel == 0 || samples_per_texel > max_samples_per_texel)
        return Status{ErrorCode::bad_argument, std::to_string(samples_per_texel) +
                                                   " samples per texel, outside 1.." +
                                                   std::to_string(max_samples_per_texel)};
    const TextureDesc desc{size, scene.type, 3};
    TESSERA_TRY(check_desc(desc));
    try {
        return std::unique_ptr<TexelSource>(std::make_unique<BakedTexture>(
            std::move(scene), window, desc, samples_per_texel, seed));
    } catch (const std::bad_alloc&) {
        return Status{ErrorCode::runtime, "out of memory for the baker"};
    }
}

} // namespace tessera::corpus
