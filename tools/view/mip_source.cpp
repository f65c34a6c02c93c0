#include "tools/view/mip_source.h"

#include "format/samples.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace tessera {
namespace {

using Sums = std::vector<double>;

double sample_value(const std::byte* at, SampleType type) {
    const std::uint16_t sample = load_sample(at, type);
    return traits_of(type).is_float ? static_cast<double>(half_to_float(sample)) : sample;
}

std::uint16_t rounded_sample(double value, SampleType type) {
    return traits_of(type).is_float ? float_to_half(static_cast<float>(value))
                                    : static_cast<std::uint16_t>(std::floor(value + 0.5));
}

class MipSource final : public TexelSource {
public:
    MipSource(TexelSource& source, const AtlasMips& mips, std::uint32_t tile_v)
        : source_(source), mips_(mips), tile_v_(tile_v), desc_(source.desc()) {
        desc_.size = mips.kept_size();
    }

    const TextureDesc& desc() const override { return desc_; }

    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        std::ranges::fill(out, std::byte{0});
        if (const Box4 part = intersect(box, Box4::whole(source_.desc().size)); !is_empty(part)) {
            std::vector<std::byte> texels(desc_.box_bytes(part));
            TESSERA_TRY(source_.read(part, texels));
            copy_box(part, part, texels, box, out, desc_.texel_bytes());
        }
        for (unsigned mip = 1; mip <= mips_.count(); ++mip)
            TESSERA_TRY(read_mip(mip, box, out));
        return {};
    }

private:
    static bool is_empty(const Box4& box) {
        return std::ranges::any_of(box.extent(), [](std::uint32_t n) { return n == 0; });
    }

    Status read_mip(unsigned mip, const Box4& box, std::span<std::byte> out) const {
        const auto begin = mips_.begin(mip), size = mips_.size(mip);
        const Extent4& whole = desc_.size;
        Box4 rest = intersect(box, {{begin[0], begin[1], 0, 0},
                                    {begin[0] + size[0], begin[1] + size[1], whole[2], whole[3]}});
        if (is_empty(rest))
            return {};
        // Reads the rows that one row of tiles contributes to, so that no tile is read twice.
        const std::uint32_t rows = std::max(tile_v_ >> mip, 1u);
        while (rest.begin[axis_v] < rest.end[axis_v]) {
            const std::uint32_t y = rest.begin[axis_v] - begin[1];
            Box4 part = rest;
            part.end[axis_v] = std::min(rest.end[axis_v], begin[1] + (y / rows + 1) * rows);
            TESSERA_TRY(average(mip, part, box, out));
            rest.begin[axis_v] = part.end[axis_v];
        }
        return {};
    }

    // Computes `part` of a mip from the texels of the atlas below it.
    Status average(unsigned mip, const Box4& part, const Box4& box,
                   std::span<std::byte> out) const {
        Box4 atlas = part;
        for (std::size_t a = 0; a < 2; ++a) {
            const std::uint32_t side = source_.desc().size[a];
            atlas.begin[a] = (part.begin[a] - mips_.begin(mip)[a]) << mip;
            atlas.end[a] = std::min((part.end[a] - mips_.begin(mip)[a]) << mip, side);
        }
        std::vector<std::byte> texels(desc_.box_bytes(atlas)), means(desc_.box_bytes(part));
        TESSERA_TRY(source_.read(atlas, texels));
        const Extent4 extent = part.extent();
        const std::size_t image = std::size_t{extent[axis_s]} * extent[axis_t];
        Sums sums;
        std::byte* next = means.data();
        for (std::uint32_t v = part.begin[axis_v]; v < part.end[axis_v]; ++v)
            for (std::uint32_t u = part.begin[axis_u]; u < part.end[axis_u]; ++u) {
                add_up(mip, u, v, atlas, texels, image, sums);
                for (const double sum : sums) {
                    store_sample(next, rounded_sample(sum, desc_.type), desc_.type);
                    next += sample_bytes(desc_.type);
                }
            }
        copy_box(part, part, means, box, out, desc_.texel_bytes());
        return {};
    }

    // Computes the mean angular image, of `image` texels, at the texel (u, v) of a mip. The mean is
    // over the texels of the atlas below it that belong to the same chart. `sums` receives one mean
    // per sample; outside the charts all of them are 0.
    void add_up(unsigned mip, std::uint32_t u, std::uint32_t v, const Box4& atlas,
                std::span<const std::byte> texels, std::size_t image, Sums& sums) const {
        const std::uint32_t x = u - mips_.begin(mip)[0], y = v - mips_.begin(mip)[1];
        const std::uint32_t own = mips_.charts(mip)[std::size_t{y} * mips_.size(mip)[0] + x];
        const std::size_t samples = image * static_cast<std::size_t>(desc_.channels);
        const std::size_t sample = sample_bytes(desc_.type);
        sums.assign(samples, 0.0);
        if (own == 0)
            return;
        double count = 0.0;
        for (std::uint32_t j = y << mip; j < std::min((y + 1) << mip, atlas.end[axis_v]); ++j)
            for (std::uint32_t i = x << mip; i < std::min((x + 1) << mip, atlas.end[axis_u]); ++i) {
                if (mips_.charts(0)[std::size_t{j} * mips_.size(0)[0] + i] != own)
                    continue;
                const std::size_t row = j - atlas.begin[axis_v], column = i - atlas.begin[axis_u];
                const std::byte* at =
                    texels.data() + (row * atlas.extent()[axis_u] + column) * samples * sample;
                for (double& sum : sums) {
                    sum += sample_value(at, desc_.type);
                    at += sample;
                }
                ++count;
            }
        for (double& sum : sums)
            sum /= count;
    }

    TexelSource& source_;
    const AtlasMips& mips_;
    const std::uint32_t tile_v_;
    TextureDesc desc_;
};

} // namespace

std::unique_ptr<TexelSource> make_mip_source(TexelSource& source, const AtlasMips& mips,
                                             std::uint32_t tile_v) {
    return std::make_unique<MipSource>(source, mips, tile_v);
}

} // namespace tessera
