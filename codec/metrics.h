// How far two textures are apart, measured box by box in bounded memory.
//
// All figures are sums over samples, so they do not depend on the order in which boxes come, as far
// as doubles allow; compare_textures fixes the order too, so its results do not depend on the
// number of threads.
//
// Half-float textures: before anything is measured, NaN becomes 0 and infinities +-65504, the
// codec's own policy. Linear 1.0 is taken to be 100 cd/m2.
#pragma once

#include "format/samples.h"
#include "format/status.h"
#include "format/texture.h"
#include "format/work.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// 10 log10(peak^2 / mse); infinite for an mse of 0.
double psnr_of(double mse, double peak);

// PU21 (Mantiuk and Azimi, "PU21: A novel perceptually uniform encoding for adapting existing
// quality metrics for HDR", Picture Coding Symposium 2021), variant banding + glare: absolute
// luminance in cd/m2, clamped to 0.005..10,000, to a scale on which 100 cd/m2 is about 256.
double pu21_encode(double luminance);

constexpr double half_peak = 31743;         // half_ordinal of 65504, the encoder's peak
constexpr double pu21_peak = 256;           // the authors' peak for PSNR and SSIM
constexpr double luminance_of_one = 100;    // cd/m2 of linear 1.0
constexpr double log2_floor = 1e-4;         // log2-PSNR is that of log2(max(x, log2_floor)), with
constexpr double log2_peak = 29.2870077666; // log2(65504 / log2_floor) as its peak

// Integer that grows by one from each half to the next; +0 and -0 are both 0.
inline std::int32_t half_ordinal(std::uint16_t half) {
    return sample_code(half, SampleType::half16);
}

struct SamplePlace {
    std::uint32_t u = 0, v = 0, s = 0, t = 0, channel = 0;
    bool operator==(const SamplePlace&) const = default;
};

// Sums of errors over the texels seen so far.
class ErrorSums {
public:
    explicit ErrorSums(const TextureDesc& desc) : desc_(desc) {}

    // Adds the texels of `box`, of at most 2^20 texels; both spans hold desc.box_bytes(box) bytes.
    // matters: one a texel, 0 where it is not to count; empty: all count.
    void add(const Box4& box, std::span<const std::byte> a, std::span<const std::byte> b,
             std::span<const std::byte> matters = {});
    // Adds sums of other texels, as if they had been seen after these.
    void merge(const ErrorSums& later);

    std::uint64_t texels() const { return texels_; } // that count
    // Peak 255 (unorm8), or half_peak over half_ordinal, which is how the codec counts (half16).
    double psnr() const; // over all samples, alpha included
    double psnr(unsigned channel) const;
    // unorm8 only: BT.709 weights on code values. Grey: as psnr(0).
    double psnr_luma() const;
    // half16 only, over the colour channels.
    double psnr_log2() const;
    double psnr_pu21() const;
    // 8-bit steps or half-float ulps, and the first sample that has it.
    std::uint32_t max_error() const { return max_error_; }
    const SamplePlace& max_error_place() const { return max_place_; }
    std::uint64_t differing_samples() const { return differing_; }
    std::uint64_t non_finite(unsigned input) const { return non_finite_[input]; } // 0: a, 1: b

private:
    void add_unorm8(const Box4& box, const std::byte* a, const std::byte* b,
                    std::span<const std::byte> matters);
    void add_half16(const Box4& box, const std::byte* a, const std::byte* b,
                    std::span<const std::byte> matters);
    void note_error(std::uint32_t error, const Box4& box, std::uint64_t texel, unsigned channel);
    unsigned colour_channels() const { return desc_.channels >= 3 ? 3 : 1; }

    TextureDesc desc_;
    std::uint64_t texels_ = 0, differing_ = 0;
    std::array<double, 4> squared_{}; // per channel
    double luma_ = 0, log2_ = 0, pu21_ = 0;
    std::array<std::uint64_t, 2> non_finite_{};
    std::uint32_t max_error_ = 0;
    SamplePlace max_place_;
};

// Mean structural similarity (Wang et al. 2004) of two pictures of one channel: Gaussian window of
// 11 x 11, sigma 1.5, places where the window fits whole, K1 = 0.01, K2 = 0.03. Along an axis
// shorter than 11 the window shrinks to the picture.
double ssim(std::span<const float> a, std::span<const float> b, std::uint32_t width,
            std::uint32_t height, double peak);

struct CompareOptions {
    bool with_ssim = true;
    unsigned threads = 0;                   // 0: all cores
    std::uint64_t slab_bytes = 64ull << 20; // texels of one input held at a time, about
    // Texels that count, as EncodeOptions::mask; nullptr: all. With a mask there is no SSIM, whose
    // windows would see the others.
    TexelSource* mask = nullptr;
    ProgressFunction progress;
};

struct Comparison {
    explicit Comparison(const TextureDesc& desc) : errors(desc) {}
    ErrorSums errors;
    bool has_ssim = false;
    double ssim_mean = 1, ssim_worst = 1; // over views: luma (unorm8), PU21 luminance (half16)
    std::uint32_t worst_s = 0, worst_t = 0;
    std::uint64_t views = 0;
    std::uint64_t compared_tiles = 0, tiles = 0; // of compare_sample
};

// Errors: difference where size, type or channels differ.
Status check_comparable(const TextureDesc& a, const TextureDesc& b);

// Walks both textures in slabs of whole views. SSIM is left out for views of more than 2^26 texels.
// Errors: difference where size, type or channels differ; bad_argument (a mask that does not fit);
// whatever the sources report.
Result<Comparison> compare_textures(TexelSource& a, TexelSource& b,
                                    const CompareOptions& options = {});

// The same without SSIM over a random `fraction` (above 0 to 1; rounded up to a whole number) of the
// tiles of 32x32x8x8, which `seed` chooses the same way on any machine. Memory: a tile a thread.
Result<Comparison> compare_sample(TexelSource& a, TexelSource& b, double fraction,
                                  std::uint64_t seed, const CompareOptions& options = {});

} // namespace tessera
