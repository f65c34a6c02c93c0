#include "codec/texels/level_texels.h"

#include "format/samples.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

unsigned difference(const LevelEntry& fine, const LevelEntry& coarse, std::size_t axis) {
    return coarse.lod(static_cast<int>(axis)) - fine.lod(static_cast<int>(axis));
}

// The axes of a dense box from the slowest to the fastest.
constexpr std::array<std::size_t, 4> dense_order{axis_v, axis_u, axis_t, axis_s};

// The two neighbours of one texel along one axis, and the weight of the second.
struct Tap {
    std::uint32_t low = 0, high = 0; // relative to the support
    float weight = 0;
};

std::vector<Tap> taps_of(std::uint32_t begin, std::uint32_t end, std::uint32_t support_begin,
                         std::uint32_t coarse_extent, unsigned lod) {
    std::vector<Tap> taps;
    const std::uint64_t joined = std::uint64_t{1} << lod;
    for (std::uint64_t x = begin; x < end; ++x) {
        // The texel's centre relative to that of coarse texel 0, in units of half a fine texel.
        const std::int64_t place =
            static_cast<std::int64_t>(2 * x + 1) - static_cast<std::int64_t>(joined);
        const std::int64_t step = 2 * static_cast<std::int64_t>(joined);
        const std::int64_t last = std::int64_t{coarse_extent} - 1;
        const std::int64_t low = place < 0 ? 0 : std::min(place / step, last);
        const std::int64_t high = std::min(low + 1, last);
        const float weight = place <= 0 || high == low ? 0.0f
                                                       : static_cast<float>(place - low * step) /
                                                             static_cast<float>(step);
        taps.push_back({static_cast<std::uint32_t>(low) - support_begin,
                        static_cast<std::uint32_t>(weight > 0 ? high : low) - support_begin,
                        weight});
    }
    return taps;
}

// `in` has outer x n x inner values, the result outer x taps x inner.
std::vector<float> interpolate_axis(const std::vector<float>& in, std::size_t n, std::size_t inner,
                                    const std::vector<Tap>& taps) {
    const std::size_t outer = in.size() / (n * inner);
    std::vector<float> out(outer * taps.size() * inner);
    float* to = out.data();
    for (std::size_t o = 0; o < outer; ++o)
        for (const Tap& tap : taps) {
            const float* low = in.data() + (o * n + tap.low) * inner;
            const float* high = in.data() + (o * n + tap.high) * inner;
            for (std::size_t i = 0; i < inner; ++i)
                to[i] = low[i] + tap.weight * (high[i] - low[i]);
            to += inner;
        }
    return out;
}

// Adds n texels of a row to sums, 2^lod texels to each. `phase` is the position of the first texel.
template <SampleType type>
void add_row(const std::byte* texel, std::uint32_t phase, std::uint32_t n, unsigned lod,
             std::size_t channels, std::int64_t* sums) {
    for (std::uint32_t s = phase; s < phase + n; ++s) {
        std::int64_t* sum = sums + (s >> lod) * channels;
        for (std::size_t c = 0; c < channels; ++c, texel += sample_bytes(type))
            sum[c] += sample_code(load_sample(texel, type), type);
    }
}

// Stores codes rounded to the nearest, ties upwards.
template <SampleType type> void store_rounded(const std::vector<float>& codes, std::byte* out) {
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const float up = codes[i] + 0.5f;
        const auto whole = static_cast<std::int32_t>(up); // rounds towards 0
        const std::int32_t code = static_cast<float>(whole) > up ? whole - 1 : whole;
        store_sample(out + i * sample_bytes(type), code_sample(code, type), type);
    }
}

} // namespace

Box4 covered_by(const Box4& box, const LevelEntry& coarse, const LevelEntry& fine) {
    Box4 covered;
    for (std::size_t a = 0; a < 4; ++a) {
        const unsigned lod = difference(fine, coarse, a);
        covered.begin[a] = box.begin[a] << lod;
        covered.end[a] = static_cast<std::uint32_t>(
            std::min<std::uint64_t>(std::uint64_t{box.end[a]} << lod, fine.size[a]));
    }
    return covered;
}

LevelMeans::LevelMeans(const TextureDesc& desc, const LevelEntry& fine, const LevelEntry& coarse,
                       const Box4& box)
    : desc_(desc), fine_(fine), coarse_(coarse), box_(box),
      sums_(static_cast<std::size_t>(box.texels()) * desc.channels) {}

void LevelMeans::add(const Box4& fine_box, std::span<const std::byte> texels) {
    const Box4 part = intersect(fine_box, covered_by(box_, coarse_, fine_));
    const std::size_t texel_bytes = desc_.texel_bytes();
    const auto add_row =
        with_type(desc_.type, []<SampleType type>() { return &tessera::add_row<type>; });
    std::array<unsigned, 4> lod{};
    for (std::size_t axis = 0; axis < 4; ++axis)
        lod[axis] = difference(fine_, coarse_, axis);
    for (std::uint32_t v = part.begin[axis_v]; v < part.end[axis_v]; ++v)
        for (std::uint32_t u = part.begin[axis_u]; u < part.end[axis_u]; ++u)
            for (std::uint32_t t = part.begin[axis_t]; t < part.end[axis_t]; ++t) {
                const std::uint32_t first = part.begin[axis_s];
                const std::uint32_t first_sum = first >> lod[axis_s];
                const std::uint64_t from = fine_box.index_of({u, v, first, t});
                const std::uint64_t to = box_.index_of(
                    {u >> lod[axis_u], v >> lod[axis_v], first_sum, t >> lod[axis_t]});
                add_row(texels.data() + from * texel_bytes, first - (first_sum << lod[axis_s]),
                        part.end[axis_s] - first, lod[axis_s], desc_.channels,
                        sums_.data() + to * desc_.channels);
            }
}

void LevelMeans::finish(std::span<std::byte> out) const {
    const Extent4 n = box_.extent();
    const std::size_t bytes = sample_bytes(desc_.type);
    // How many texels of the finer level this coarse texel covers along one axis.
    const auto joined = [this](std::size_t a, std::uint32_t at) {
        const unsigned lod = difference(fine_, coarse_, a);
        const std::uint64_t begin = std::uint64_t{box_.begin[a] + at} << lod;
        return static_cast<std::int64_t>(
            std::min<std::uint64_t>(begin + (std::uint64_t{1} << lod), fine_.size[a]) - begin);
    };
    const std::int64_t* sum = sums_.data();
    std::byte* to = out.data();
    for (std::uint32_t v = 0; v < n[axis_v]; ++v)
        for (std::uint32_t u = 0; u < n[axis_u]; ++u)
            for (std::uint32_t t = 0; t < n[axis_t]; ++t)
                for (std::uint32_t s = 0; s < n[axis_s]; ++s) {
                    const std::int64_t count = joined(axis_v, v) * joined(axis_u, u) *
                                               joined(axis_t, t) * joined(axis_s, s);
                    for (std::size_t c = 0; c < desc_.channels; ++c, to += bytes) {
                        const std::int64_t twice = 2 * *sum++ + count;
                        const std::int64_t divisor = 2 * count; // rounds down, also below 0
                        const std::int64_t mean =
                            twice >= 0 ? twice / divisor : -((-twice + divisor - 1) / divisor);
                        store_sample(to, code_sample(static_cast<std::int32_t>(mean), desc_.type),
                                     desc_.type);
                    }
                }
}

Box4 support_of(const Box4& box, const LevelEntry& fine, const LevelEntry& coarse) {
    Box4 support;
    for (std::size_t a = 0; a < 4; ++a) {
        const unsigned lod = difference(fine, coarse, a);
        const std::vector<Tap> first =
            taps_of(box.begin[a], box.begin[a] + 1, 0, coarse.size[a], lod);
        const std::vector<Tap> last = taps_of(box.end[a] - 1, box.end[a], 0, coarse.size[a], lod);
        support.begin[a] = first[0].low;
        support.end[a] = last[0].high + 1;
    }
    return support;
}

void interpolate_level(std::span<const std::byte> texels, const Box4& support, const Box4& box,
                       const LevelEntry& fine, const LevelEntry& coarse, const TextureDesc& desc,
                       std::span<std::byte> out) {
    const std::size_t bytes = sample_bytes(desc.type);
    std::vector<float> values(static_cast<std::size_t>(support.texels()) * desc.channels);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(
            sample_code(load_sample(texels.data() + i * bytes, desc.type), desc.type));
    // Starting with the slowest axis gives most of the work long rows.
    for (const std::size_t a : dense_order) {
        const std::size_t n = support.end[a] - support.begin[a];
        std::size_t after = desc.channels; // values per step along the axis
        for (std::size_t i = 3; dense_order[i] != a; --i)
            after *= support.end[dense_order[i]] - support.begin[dense_order[i]];
        const std::vector<Tap> taps = taps_of(box.begin[a], box.end[a], support.begin[a],
                                              coarse.size[a], difference(fine, coarse, a));
        if (difference(fine, coarse, a) > 0)
            values = interpolate_axis(values, n, after, taps);
    }
    with_type(desc.type, [&]<SampleType type>() { store_rounded<type>(values, out.data()); });
}

} // namespace tessera
