// How far decoded texels are from the original, in every measure of the report. All codecs, ours
// and the rivals, are measured here, between two buffers.
//
// PSNRs are pooled: one mean squared error over all samples concerned. Peak 255, or half_peak over
// half_ordinal (codec/metrics.h). Infinite where there is no error.
#pragma once

#include "codec/metrics.h"
#include "tools/lab/rd/rd_texture.h"

#include <memory>
#include <optional>

namespace tessera {

struct Quality {
    double psnr_rgb = 0;            // over the colour channels
    std::optional<double> psnr_yuv; // unorm8 RGB: (6 Y + Cb + Cr) / 8 of BT.709, as JPEG Pleno
    double psnr_worst_view = 0;     // of RGB, over the views of one (s,t) each
    std::uint32_t worst_s = 0, worst_t = 0;
    std::optional<double> psnr_foreground;      // of RGB, where the original is not the background
    std::optional<double> psnr_rendered;        // pictures of the paper's five views, as displayed
    std::uint32_t max_error = 0;                // 8-bit steps, or ulps of half
    std::optional<double> psnr_pu21, psnr_log2; // half16
};

// Measures against one texture; draws its views once.
class QualityMeter {
public:
    // `original` must outlive it.
    QualityMeter(const RdTexture& original, unsigned threads);
    ~QualityMeter();
    // `decoded` holds as many bytes as the original. Errors: runtime, also when interrupted.
    Result<Quality> measure(std::span<const std::byte> decoded,
                            const ProgressFunction& progress = {});

private:
    Result<std::vector<std::byte>> draw(std::span<const std::byte> texels,
                                        const ProgressFunction& progress) const;
    const RdTexture& original_;
    unsigned threads_;
    std::vector<std::byte> drawn_; // RGB of the original's five views
};

} // namespace tessera
