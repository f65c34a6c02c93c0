#include "tools/lab/rd/quality.h"

#include "format/sampler.h"
#include "format/texture.h"
#include "format/work.h"
#include "tools/lab/rd/bt709.h"
#include "tools/view/camera.h"
#include "tools/view/view_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace tessera {
namespace {

constexpr Lens lens{45, 320, 240}; // for the rendered views
// Small along s and t, as in render_stage.cpp, because a camera sees each point from one direction.
constexpr Extent4 render_block{8, 8, 4, 4};

// Sums of squared errors over some rows of v.
struct QualitySums {
    QualitySums(const TextureDesc& desc)
        : errors(desc), views(std::size_t{desc.size[axis_s]} * desc.size[axis_t]) {}
    ErrorSums errors;
    std::vector<double> views; // t-major
    double foreground = 0;
    std::uint64_t foreground_texels = 0;
    std::array<double, 3> yuv{};

    void merge(const QualitySums& later) {
        errors.merge(later.errors);
        for (std::size_t i = 0; i < views.size(); ++i)
            views[i] += later.views[i];
        foreground += later.foreground;
        foreground_texels += later.foreground_texels;
        for (std::size_t i = 0; i < 3; ++i)
            yuv[i] += later.yuv[i];
    }
};

// The channels that PSNR is over: not the alpha of four. Two are taken as normals.
unsigned colours(const TextureDesc& desc) {
    return std::min<unsigned>(desc.channels, 3);
}

// The integer by which samples are compared; see metrics.h.
std::int64_t code_of(const std::byte* sample, bool is_float) {
    if (!is_float)
        return std::to_integer<std::int64_t>(*sample);
    std::uint16_t half;
    std::memcpy(&half, sample, 2);
    if ((half & 0x7C00) == 0x7C00) // NaN and infinity, handled as the codec does
        half = half & 0x3FF ? 0 : static_cast<std::uint16_t>((half & 0x8000) | 0x7BFF);
    return half_ordinal(half);
}

void add_angular_image(const RdTexture& original, const std::byte* a, const std::byte* b,
                       QualitySums& sums) {
    const TextureDesc& desc = original.desc;
    const std::size_t step = sample_bytes(desc.type), texel = desc.texel_bytes();
    const bool is_float = traits_of(desc.type).is_float, coloured = colours(desc) == 3 && !is_float;
    for (double& view : sums.views) {
        const bool foreground = std::memcmp(a, original.background.data(), texel) != 0;
        sums.foreground_texels += foreground;
        if (std::memcmp(a, b, texel) != 0) {
            std::int64_t d[3] = {};
            double squared = 0;
            for (unsigned c = 0; c < colours(desc); ++c) {
                d[c] = code_of(a + c * step, is_float) - code_of(b + c * step, is_float);
                squared += static_cast<double>(d[c] * d[c]);
            }
            view += squared;
            sums.foreground += foreground ? squared : 0;
            if (coloured) {
                const auto e = to_bt709(static_cast<double>(d[0]), static_cast<double>(d[1]),
                                        static_cast<double>(d[2])); // the transform is linear
                sums.yuv[0] += e.y * e.y;
                sums.yuv[1] += e.cb * e.cb;
                sums.yuv[2] += e.cr * e.cr;
            }
        }
        a += texel;
        b += texel;
    }
}

// Adds in parts, because ErrorSums takes up to 2^20 texels at a time.
void add_errors(const TextureDesc& desc, const Box4& image, const std::byte* a, const std::byte* b,
                ErrorSums& errors) {
    const std::size_t row = desc.texel_bytes() * desc.size[axis_s];
    const std::uint32_t step = std::max(1u, (1u << 20) / desc.size[axis_s]);
    for (std::uint32_t t = 0; t < desc.size[axis_t]; t += step) {
        Box4 part = image;
        part.begin[axis_t] = t;
        part.end[axis_t] = std::min(t + step, desc.size[axis_t]);
        const std::size_t bytes = row * (part.end[axis_t] - t);
        errors.add(part, {a + t * row, bytes}, {b + t * row, bytes});
    }
}

QualitySums sum_of_row(const RdTexture& original, std::span<const std::byte> decoded,
                       std::uint32_t v) {
    const TextureDesc& desc = original.desc;
    QualitySums sums(desc);
    for (std::uint32_t u = 0; u < desc.size[axis_u]; ++u) {
        const std::byte* a = original.texel(u, v, 0, 0);
        const std::byte* b = decoded.data() + (a - original.texels.data());
        Box4 image{{u, v, 0, 0}, {u + 1, v + 1, desc.size[axis_s], desc.size[axis_t]}};
        add_errors(desc, image, a, b, sums.errors);
        add_angular_image(original, a, b, sums);
    }
    return sums;
}

// Adds rows in order, so that the result does not depend on the number of threads.
Result<QualitySums> sum_of_all(const RdTexture& original, std::span<const std::byte> decoded,
                               unsigned threads) {
    QualitySums all(original.desc);
    const std::uint32_t rows = original.desc.size[axis_v], step = 4 * thread_count(threads);
    for (std::uint32_t v0 = 0; v0 < rows; v0 += step) {
        const std::uint32_t count = std::min(step, rows - v0);
        std::vector<QualitySums> parts(count, QualitySums(original.desc));
        TESSERA_TRY(parallel_for(count, threads, [&](std::uint64_t i) {
            parts[i] = sum_of_row(original, decoded, v0 + static_cast<std::uint32_t>(i));
            return Status();
        }));
        for (const QualitySums& part : parts)
            all.merge(part);
    }
    return all;
}

double psnr_over(double squared, double samples, double peak) {
    return psnr_of(squared / samples, peak);
}

Quality quality_of(const RdTexture& original, const QualitySums& sums) {
    const TextureDesc& desc = original.desc;
    const bool hdr = traits_of(desc.type).is_float;
    const double peak = traits_of(desc.type).largest_code, channels = colours(desc);
    const auto texels = static_cast<double>(original.texel_count());
    const double per_view = texels / static_cast<double>(sums.views.size());
    Quality q;
    double total = 0, worst = -1;
    for (std::size_t i = 0; i < sums.views.size(); ++i) {
        total += sums.views[i];
        if (sums.views[i] > worst) {
            worst = sums.views[i];
            q.worst_s = static_cast<std::uint32_t>(i % desc.size[axis_s]);
            q.worst_t = static_cast<std::uint32_t>(i / desc.size[axis_s]);
        }
    }
    q.psnr_rgb = psnr_over(total, texels * channels, peak);
    q.psnr_worst_view = psnr_over(worst, per_view * channels, peak);
    if (sums.foreground_texels > 0)
        q.psnr_foreground = psnr_over(sums.foreground,
                                      static_cast<double>(sums.foreground_texels) * channels, peak);
    q.max_error = sums.errors.max_error();
    if (hdr) {
        q.psnr_pu21 = sums.errors.psnr_pu21();
        q.psnr_log2 = sums.errors.psnr_log2();
    } else if (channels == 3) {
        const auto plane = [&](std::size_t i) { return psnr_over(sums.yuv[i], texels, 255); };
        q.psnr_yuv = (6 * plane(0) + plane(1) + plane(2)) / 8;
    }
    return q;
}

} // namespace

QualityMeter::QualityMeter(const RdTexture& original, unsigned threads)
    : original_(original), threads_(threads) {}
QualityMeter::~QualityMeter() = default;

Result<std::vector<std::byte>> QualityMeter::draw(std::span<const std::byte> texels,
                                                  const ProgressFunction& progress) const {
    MemorySource source(original_.desc, texels);
    const glm::dvec4 behind = texel_value(original_.desc, original_.background.data());
    RenderOptions options;
    options.threads = threads_;
    options.progress = progress;
    const auto renderer = make_texture_renderer(
        source, render_block, *original_.window,
        original_.desc.channels >= 3 ? glm::dvec3(behind) : glm::dvec3(behind.x), options);
    std::vector<std::byte> pictures;
    for (const NamedPose& named : paper_views()) {
        TESSERA_TRY_ASSIGN(const auto camera, make_camera(named.pose, lens));
        TESSERA_TRY_ASSIGN(const auto view, renderer->render(camera));
        const Picture picture = to_picture(view, original_.desc.type);
        pictures.insert(pictures.end(), picture.rgb.begin(), picture.rgb.end());
    }
    return pictures;
}

Result<Quality> QualityMeter::measure(std::span<const std::byte> decoded,
                                      const ProgressFunction& progress) {
    if (decoded.size() != original_.texels.size())
        return Status(ErrorCode::runtime, "the decoded texture has a different size");
    TESSERA_TRY_ASSIGN(const auto sums, sum_of_all(original_, decoded, threads_));
    Quality quality = quality_of(original_, sums);
    if (!original_.window)
        return quality;
    if (drawn_.empty()) {
        TESSERA_TRY_ASSIGN(drawn_, draw(original_.texels, progress));
    }
    TESSERA_TRY_ASSIGN(const auto drawn, draw(decoded, progress));
    double squared = 0;
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        const double d = std::to_integer<int>(drawn[i]) - std::to_integer<int>(drawn_[i]);
        squared += d * d;
    }
    quality.psnr_rendered = psnr_over(squared, static_cast<double>(drawn_.size()), 255);
    return quality;
}

} // namespace tessera
