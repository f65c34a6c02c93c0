// Measures how far two textures differ, box by box in bounded memory.
//
// All figures are sums over samples, so they depend on the order of boxes only through rounding of
// doubles. compare_textures() and compare_sample() fix the order, so their results do not depend on
// the number of threads.
//
// Half-float textures: before anything is measured, NaN becomes 0 and infinities become +-65504, as
// in the encoder. Linear 1.0 stands for 100 cd/m2.
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

// 10 log10(peak^2 / mse) in dB; infinity if mse is 0.
double psnr_of(double mse, double peak);

// PU21 (Mantiuk and Azimi, "PU21: A novel perceptually uniform encoding for adapting existing
// quality metrics for HDR", Picture Coding Symposium 2021), variant banding + glare. Converts
// absolute luminance in cd/m2, clamped to 0.005..10,000, to a scale on which 100 cd/m2 is about
// 256.
double pu21_encode(double luminance);

constexpr double pu21_peak = 256;           // the authors' peak for PSNR and SSIM
constexpr double luminance_of_one = 100;    // cd/m2 of linear 1.0
constexpr double log2_floor = 1e-4;         // log2-PSNR compares log2(max(x, log2_floor))
constexpr double log2_peak = 29.2870077666; // its peak, log2(65504 / log2_floor)

// An integer that grows by one from each half float to the next. +0 and -0 are both 0.
inline std::int32_t half_ordinal(std::uint16_t half) {
    return sample_code(half, SampleType::half16);
}

struct SamplePlace {
    std::uint32_t u = 0, v = 0, s = 0, t = 0, channel = 0;
    bool operator==(const SamplePlace&) const = default;
};

// Sums of errors over texels. Copies are independent; not thread-safe.
class ErrorSums {
public:
    explicit ErrorSums(const TextureDesc& desc) : desc_(desc) {}

    // Adds the texels of `box`, at most 2^20; `a` and `b` hold desc.box_bytes(box) bytes each.
    // `matters`: one byte per texel, 0 if it does not count; empty if all count.
    void add(const Box4& box, std::span<const std::byte> a, std::span<const std::byte> b,
             std::span<const std::byte> matters = {});
    // Adds sums over other texels, as if these had been added after those seen so far.
    void merge(const ErrorSums& later);

    std::uint64_t texels() const { return texels_; } // that count
    // PSNR in dB. The peak is the largest code: 255 for unorm8, 31743 for half16.
    double psnr() const; // over all samples, including alpha
    double psnr(unsigned channel) const;
    // unorm8 only: PSNR of BT.709 luma of the code values. With fewer than 3 channels, psnr(0).
    double psnr_luma() const;
    // half16 only: over the colour channels, without alpha.
    double psnr_log2() const;
    double psnr_pu21() const;
    // The largest error of a sample, in 8-bit steps or half-float ulps, and the first such sample.
    std::uint32_t max_error() const { return max_error_; }
    const SamplePlace& max_error_place() const { return max_place_; }
    std::uint64_t differing_samples() const { return differing_; }
    // half16 only: how many samples of input 0 (a) or 1 (b) were NaN or infinite.
    std::uint64_t non_finite(unsigned input) const { return non_finite_[input]; }

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

// Mean structural similarity (Wang et al. 2004) of two pictures with one channel of width x height
// values each. Gaussian window of 11 x 11, sigma 1.5, at all positions where it fits;
// K1 = 0.01, K2 = 0.03. Along an axis shorter than 11 the window has the picture's size.
double ssim(std::span<const float> a, std::span<const float> b, std::uint32_t width,
            std::uint32_t height, double peak);

struct CompareOptions {
    bool with_ssim = true;
    unsigned threads = 0;                   // 0: all cores
    std::uint64_t slab_bytes = 64ull << 20; // approximate texel memory per input
    // Texels that count, as in EncodeOptions::mask; nullptr: all. With a mask there is no SSIM
    // because its windows would include masked texels.
    TexelSource* mask = nullptr;
    ProgressFunction progress;
};

struct Comparison {
    explicit Comparison(const TextureDesc& desc) : errors(desc) {}
    ErrorSums errors;
    bool has_ssim = false;
    double ssim_mean = 1, ssim_worst = 1; // per view: of luma (unorm8), of PU21 luminance (half16)
    std::uint32_t worst_s = 0, worst_t = 0;
    std::uint64_t views = 0;
    std::uint64_t compared_tiles = 0, tiles = 0; // compare_sample only
};

// Errors: difference if size, type or channels differ.
Status check_comparable(const TextureDesc& a, const TextureDesc& b);

// Compares all texels, in slabs of whole views, without SSIM for views of more than 2^26 texels.
// Errors: difference (size, type or channels), bad_argument (the mask), those of the sources.
Result<Comparison> compare_textures(TexelSource& a, TexelSource& b,
                                    const CompareOptions& options = {});

// Compares a random `fraction` (above 0, at most 1) of the tiles of 32x32x8x8, rounded up to a
// whole number, without SSIM. `seed` gives the same tiles on every machine. Memory: one tile per
// thread. Errors: as compare_textures(); bad_argument for a bad fraction.
Result<Comparison> compare_sample(TexelSource& a, TexelSource& b, double fraction,
                                  std::uint64_t seed, const CompareOptions& options = {});

} // namespace tessera
