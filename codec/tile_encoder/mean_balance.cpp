#include "codec/tile_encoder/mean_balance.h"

#include "codec/search_kernels/search_kernels.h"
#include "format/samples.h"
#include "format/tile/dequantizer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace tessera {
namespace {

constexpr double most_asked = 0.5; // of a block, in steps of its first coefficient

// The change of the planes that a small change of the channels makes.
Means planes_of(const Means& c, ColourTransform transform) {
    if (transform == ColourTransform::none)
        return c;
    return {(c[0] + 2 * c[1] + c[2]) / 4, c[0] - c[2], c[1] - (c[0] + c[2]) / 2, c[3]};
}

using ChannelSums = std::array<std::int64_t, max_planes>;

// The sums of a - b by channel.
ChannelSums differences_of_bytes(std::span<const std::byte> a, std::span<const std::byte> b,
                                 std::size_t channels) {
    static_assert(byte_lanes % 3 == 0 && byte_lanes % 4 == 0, "whole texels");
    ChannelSums sums{};
    const std::size_t rows = a.size() / byte_lanes;
    for (std::size_t row = 0; row < rows; row += most_byte_rows) {
        const std::size_t at = row * byte_lanes;
        std::array<std::int16_t, byte_lanes> sum{};
        search_kernels().add_byte_differences(reinterpret_cast<const unsigned char*>(&a[at]),
                                              reinterpret_cast<const unsigned char*>(&b[at]),
                                              std::min(most_byte_rows, rows - row), sum.data());
        for (std::size_t i = 0; i < byte_lanes; ++i)
            sums[i % channels] += sum[i];
    }
    for (std::size_t at = rows * byte_lanes; at < a.size(); ++at)
        sums[at % channels] += std::to_integer<int>(a[at]) - std::to_integer<int>(b[at]);
    return sums;
}

ChannelSums differences_that_matter(const std::vector<std::byte>& decoded, const TileTexels& tile,
                                    SampleType type, std::size_t channels) {
    const std::size_t bytes = sample_bytes(type);
    const auto code = [&](const std::vector<std::byte>& texels, std::size_t i) {
        return sample_code(load_sample(&texels[i * bytes], type), type);
    };
    ChannelSums sums{};
    for (std::size_t i = 0; i < decoded.size() / (channels * bytes); ++i)
        for (std::size_t c = 0; c < channels && !tile.is_free(i); ++c)
            sums[c] += code(decoded, i * channels + c) - code(tile.texels, i * channels + c);
    return sums;
}

} // namespace

double largest_of(const Means& means) {
    double largest = 0;
    for (const double mean : means)
        largest = std::max(largest, std::fabs(mean));
    return largest;
}

Means channels_of(const Means& p, ColourTransform transform) {
    if (transform == ColourTransform::none)
        return p;
    const double middle = p[0] - p[2] / 2, blue = middle - p[1] / 2;
    return {blue + p[1], p[2] + middle, blue, p[3]};
}

Means MeanMeter::error(const TileTexels& tile, const TilePlanes& decoded) {
    texels_.resize(tile.texels.size());
    if (coding_->parameters.filter.is_on()) {
        filtered_ = decoded;
        filter_tile(*coding_, scratch_, filtered_);
        texels_from_planes(filtered_, *colour_, texels_);
    } else {
        texels_from_planes(decoded, *colour_, texels_);
    }
    const SampleType type = colour_->desc.type;
    const std::size_t bytes = sample_bytes(type), channels = colour_->desc.channels;
    const std::size_t count = tile.texels.size() / (channels * bytes);
    ChannelSums sum{};
    if (bytes == 1 && tile.matters.empty())
        sum = differences_of_bytes(texels_, tile.texels, channels);
    else
        sum = differences_that_matter(texels_, tile, type, channels);
    const std::size_t matter = count - free_count(tile.matters);
    Means means{};
    for (std::size_t c = 0; c < channels && matter > 0; ++c)
        means[c] = static_cast<double>(sum[c]) / static_cast<double>(matter);
    return means;
}

MeanDebt::MeanDebt(const Means& error, int texels, double gain, const TileCoding& coding,
                   const ColourCoding& colour)
    : coding_(coding), gain_(gain), unit_(1 << value_bits(colour.desc.type)), left_(texels),
      sum_(planes_of(error, colour.transform)) {
    for (double& sum : sum_)
        sum *= -left_;
}

void MeanDebt::ask_of(BlockCoefficients& block) const {
    // The first coefficient is the block's mean times this.
    const double scale = std::sqrt(static_cast<double>(block.shape.texels()));
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const double most = most_asked * coding_.parameters.step[plane].value();
        block.plane[plane][0] +=
            static_cast<float>(std::clamp(gain_ * sum_[plane] / left_ * scale, -most, most));
    }
}

void MeanDebt::count(const Block& block, const TilePlanes& before, const TilePlanes& after) {
    const auto& n = block.shape.n;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        std::int64_t change = 0;
        for (int t = 0; t < n[3]; ++t)
            for (int s = 0; s < n[2]; ++s)
                for (int v = 0; v < n[1]; ++v) {
                    const auto row = static_cast<std::size_t>(
                        plane_index(after.shape, block.origin[0], block.origin[1] + v,
                                    block.origin[2] + s, block.origin[3] + t));
                    for (std::size_t at = row; at < row + n[0]; ++at)
                        change += after.plane[plane][at] - before.plane[plane][at];
                }
        sum_[plane] -= static_cast<double>(change) / unit_;
    }
    left_ -= block.shape.texels();
}

} // namespace tessera
