// Compares decoded texels with the original in every measure of the report. Tessera and its rivals
// are measured by the same code, between two buffers.
//
// Each PSNR comes from one mean squared error over all its samples. The peak is 255 for 8-bit
// samples. Half floats are compared as half_ordinal() (codec/metrics.h), with the largest code as the
// peak. PSNR is infinite if there is no error.
#pragma once

#include "codec/metrics.h"
#include "tools/lab/rd/rd_texture.h"

#include <memory>
#include <optional>

namespace tessera {

struct Quality {
    double psnr_rgb = 0;            // over the colour channels
    std::optional<double> psnr_yuv; // unorm8 RGB: (6 Y + Cb + Cr) / 8 of BT.709, as in JPEG Pleno
    double psnr_worst_view = 0;     // RGB, the lowest of all views
    std::uint32_t worst_s = 0, worst_t = 0;
    std::optional<double> psnr_foreground;      // RGB, texels that differ from the background
    std::optional<double> psnr_rendered;        // displayed pictures of the paper's five views
    std::uint32_t max_error = 0;                // 8-bit steps, or half-float ulps
    std::optional<double> psnr_pu21, psnr_log2; // half16 only
};

// Measures decoded textures against one original, whose views it draws only once.
class QualityMeter {
public:
    // `original` must outlive it.
    QualityMeter(const RdTexture& original, unsigned threads);
    ~QualityMeter();
    // `decoded` has the layout and size of the original. Errors: runtime, if its size differs or
    // if the user interrupts.
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
