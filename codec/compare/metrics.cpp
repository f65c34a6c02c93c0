#include "codec/metrics.h"

#include "codec/texels/texel_mask.h"
#include "codec/tile/tile_texels.h"
#include "format/io/bytes.h"
#include "format/levels.h"
#include "format/samples.h"
#include "format/work.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <new>

namespace tessera {
namespace {

// BT.709 luma weights times 10,000, so that sums are exact integers.
constexpr std::int64_t luma_r = 2126, luma_g = 7152, luma_b = 722, luma_one = 10000;

constexpr std::uint64_t max_view_texels = 1ull << 26;
// The unit of work has the size of the codec's default tiles, so that no tile is decoded twice.
constexpr Extent4 work_extent{32, 32, 8, 8};
// Floats between views: without them, a power of two puts a texel of all views into one cache set.
constexpr std::size_t view_padding = 16;

// Replaces NaN and infinities as the codec does.
std::uint16_t finite_half(std::uint16_t half, std::uint64_t& replaced) {
    if ((half & 0x7C00) != 0x7C00)
        return half;
    ++replaced;
    return half & 0x3FF ? std::uint16_t{0} : static_cast<std::uint16_t>((half & 0x8000) | 0x7BFF);
}

std::uint16_t finite_half(std::uint16_t half) {
    std::uint64_t ignored = 0;
    return finite_half(half, ignored);
}

// pu21_encode, interpolated between 1024 points per octave, because std::pow costs too much per
// sample. The error is below 1e-4 on the scale of 0..600.
class Pu21Table {
public:
    Pu21Table() : points_((last_ >> shift_) - (first_ >> shift_) + 2) {
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const auto bits = static_cast<std::uint32_t>(((first_ >> shift_) + i) << shift_);
            points_[i] = static_cast<float>(pu21_encode(std::bit_cast<float>(bits)));
        }
    }
    float operator()(float luminance) const {
        const float clamped = std::clamp(luminance, 0.005f, 10000.0f);
        const std::uint32_t bits = std::bit_cast<std::uint32_t>(clamped);
        const std::size_t i = (bits >> shift_) - (first_ >> shift_);
        const auto part = static_cast<float>(bits & ((1u << shift_) - 1)) * (1.0f / (1u << shift_));
        return points_[i] + (points_[i + 1] - points_[i]) * part;
    }

private:
    static constexpr unsigned shift_ = 13;
    static constexpr std::uint32_t first_ = std::bit_cast<std::uint32_t>(0.004f);
    static constexpr std::uint32_t last_ = std::bit_cast<std::uint32_t>(10001.0f);
    std::vector<float> points_;
};

const Pu21Table& pu21_table() {
    static const Pu21Table table;
    return table;
}

float pu21_of_half(std::uint16_t half) {
    return pu21_table()(half_to_float(half) * static_cast<float>(luminance_of_one));
}

// log2(max(x, log2_floor)) of a half.
double log2_of_half(std::uint16_t half) {
    static const std::vector<float> table = [] {
        std::vector<float> t(65536);
        for (std::uint32_t i = 0; i < 65536; ++i) {
            const double x = half_to_float(finite_half(static_cast<std::uint16_t>(i)));
            t[i] = static_cast<float>(std::log2(std::max(x, log2_floor)));
        }
        return t;
    }();
    return table[half];
}

// The value that SSIM compares: 8-bit luma rounded to a step, or the PU21 code of BT.709 luminance.
float structure_value(bool is_float, unsigned channels, const std::byte* texel) {
    if (!is_float) {
        const auto at = [&](int c) { return std::to_integer<std::int64_t>(texel[c]); };
        return static_cast<float>(
            channels < 3
                ? at(0)
                : (luma_r * at(0) + luma_g * at(1) + luma_b * at(2) + luma_one / 2) / luma_one);
    }
    const auto at = [&](int c) {
        return half_to_float(finite_half(load_le<std::uint16_t>(texel + 2 * c)));
    };
    const float y = channels < 3 ? at(0) : 0.2126f * at(0) + 0.7152f * at(1) + 0.0722f * at(2);
    return pu21_table()(y * static_cast<float>(luminance_of_one));
}

std::vector<float> gaussian_window(std::uint32_t extent) {
    const std::uint32_t n = std::min(extent, 11u);
    std::vector<float> window(n);
    double sum = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
        const double x = i - (n - 1) / 2.0;
        window[i] = static_cast<float>(std::exp(-x * x / (2 * 1.5 * 1.5)));
        sum += static_cast<double>(window[i]);
    }
    for (float& w : window)
        w = static_cast<float>(static_cast<double>(w) / sum);
    return window;
}

// One row of each of the four windowed means that SSIM needs.
struct MomentRows {
    explicit MomentRows(std::size_t width) : a(width), b(width), squares(width), products(width) {}
    void clear() {
        for (auto* row : {&a, &b, &squares, &products})
            std::fill(row->begin(), row->end(), 0.0f);
    }
    std::vector<float> a, b, squares, products; // squares: a^2 + b^2
};

// `a` and `b` are centred on 0: that leaves variances unchanged and makes floats more precise.
void filter_row(const float* __restrict a, const float* __restrict b,
                const std::vector<float>& window, MomentRows& out) {
    const std::size_t width = out.a.size();
    out.clear();
    // The compiler vectorises only with the promise that these do not overlap.
    float* __restrict mean_a = out.a.data();
    float* __restrict mean_b = out.b.data();
    float* __restrict squares = out.squares.data();
    float* __restrict products = out.products.data();
    for (std::size_t k = 0; k < window.size(); ++k) {
        const float w = window[k];
        for (std::size_t x = 0; x < width; ++x) {
            const float p = a[x + k], q = b[x + k];
            mean_a[x] += w * p;
            mean_b[x] += w * q;
            squares[x] += w * (p * p + q * q);
            products[x] += w * (p * q);
        }
    }
}

void add_row(const std::vector<float>& in, float w, std::vector<float>& out) {
    const float* __restrict from = in.data();
    float* __restrict to = out.data();
    for (std::size_t x = 0; x < in.size(); ++x)
        to[x] += w * from[x];
}

void add_rows(const MomentRows& in, float w, MomentRows& out) {
    add_row(in.a, w, out.a);
    add_row(in.b, w, out.b);
    add_row(in.squares, w, out.squares);
    add_row(in.products, w, out.products);
}

double sum_of_row(const MomentRows& m, float offset, float c1, float c2) {
    double sum = 0;
    for (std::size_t x = 0; x < m.a.size(); ++x) {
        const float a = m.a[x] + offset, b = m.b[x] + offset;
        // Rounded in the same way as the covariance, so that equal pictures give exactly 1.
        const float variances = m.squares[x] - (m.a[x] * m.a[x] + m.b[x] * m.b[x]);
        const float covariance = m.products[x] - m.a[x] * m.b[x];
        const float luminance = (2 * a * b + c1) / (a * a + b * b + c1);
        sum += static_cast<double>(luminance * (2 * covariance + c2) / (variances + c2));
    }
    return sum;
}

template <class Body> Status for_each_index(std::size_t count, unsigned threads, const Body& body) {
    std::vector<int> workers(threads);
    return parallel_for(
        workers, count, [&](int, std::size_t i) { return body(i); }, [](std::size_t) {});
}

// The extents of a slab: some views with all (u, v) positions. Multiples of 8 views along s and t,
// as in the codec's tiles, avoid decoding tiles twice.
Extent4 slab_extent(const TextureDesc& desc, std::uint64_t budget) {
    Extent4 e = desc.size;
    const auto fits = [&] { return desc.box_bytes(Box4::whole(e)) <= budget; };
    for (int axis : {axis_t, axis_s}) {
        auto& n = e[static_cast<std::size_t>(axis)];
        while (!fits() && n > 8)
            n = std::max(8u, (n / 2 + 7) / 8 * 8);
    }
    for (int axis : {axis_t, axis_s}) {
        auto& n = e[static_cast<std::size_t>(axis)];
        while (!fits() && n > 1)
            n = (n + 1) / 2;
    }
    for (int axis : {axis_v, axis_u}) { // views that are too large for memory are cut
        auto& n = e[static_cast<std::size_t>(axis)];
        while (!fits() && n > work_extent[axis_u])
            n = (n + 1) / 2;
    }
    return e;
}

// One comparison. Computes errors slab by slab, then the SSIM of the views gathered on the way.
class Comparer {
public:
    Comparer(TexelSource& a, TexelSource& b, const CompareOptions& options)
        : a_(a), b_(b), desc_(a.desc()), options_(options), result_(desc_) {
        threads_ = thread_count(options.threads);
        result_.has_ssim =
            options.with_ssim && options.mask == nullptr && view_texels() <= max_view_texels;
    }

    Result<Comparison> run() {
        const TileGrid slabs(desc_.size, slab_extent(desc_, options_.slab_bytes));
        // Slabs are cut inside a view only if the budget is smaller than a view.
        result_.has_ssim &= slabs.count()[axis_u] == 1 && slabs.count()[axis_v] == 1;
        for (std::uint64_t i = 0; i < slabs.tiles(); ++i)
            TESSERA_TRY(add_slab(slabs.box(i)));
        if (result_.has_ssim)
            result_.ssim_mean = ssim_sum_ / static_cast<double>(result_.views);
        return result_;
    }

private:
    std::uint64_t view_texels() const {
        return std::uint64_t{desc_.size[axis_u]} * desc_.size[axis_v];
    }

    std::size_t view_stride() const { return view_texels() + view_padding; }

    Status add_slab(const Box4& slab) {
        TESSERA_TRY(a_.begin_slab(slab));
        TESSERA_TRY(b_.begin_slab(slab));
        if (result_.has_ssim) {
            try {
                const std::size_t views = slab.texels() / view_texels();
                plane_a_.resize(views * view_stride());
                plane_b_.resize(views * view_stride());
            } catch (const std::bad_alloc&) {
                return {ErrorCode::runtime, "out of memory"};
            }
        }
        TESSERA_TRY(add_errors(slab));
        return result_.has_ssim ? add_structure(slab) : Status();
    }

    Status add_errors(const Box4& slab) {
        const TileGrid boxes(slab.extent(), work_extent);
        std::vector<ErrorSums> sums(boxes.tiles(), ErrorSums(desc_));
        TESSERA_TRY(for_each_index(boxes.tiles(), threads_, [&](std::uint64_t i) {
            Box4 box = boxes.box(i);
            for (std::size_t axis = 0; axis < 4; ++axis) {
                box.begin[axis] += slab.begin[axis];
                box.end[axis] += slab.begin[axis];
            }
            return add_box(slab, box, sums[i]);
        }));
        for (const ErrorSums& part : sums) // in order, whatever the threads
            result_.errors.merge(part);
        return {};
    }

    Status add_box(const Box4& slab, const Box4& box, ErrorSums& sums) {
        std::vector<std::byte> texels_a(desc_.box_bytes(box)), texels_b(desc_.box_bytes(box));
        TESSERA_TRY(a_.read(box, texels_a));
        TESSERA_TRY(b_.read(box, texels_b));
        std::vector<std::byte> matters;
        TESSERA_TRY(read_mask(options_.mask, box, matters));
        sums.add(box, texels_a, texels_b, matters);
        if (result_.has_ssim) {
            gather(slab, box, texels_a.data(), plane_a_);
            gather(slab, box, texels_b.data(), plane_b_);
        }
        advance(box.texels());
        return {};
    }

    // Copies the texels of `box` into one picture per view, in the order s, t of the slab.
    void gather(const Box4& slab, const Box4& box, const std::byte* texel,
                std::vector<float>& planes) const {
        const std::size_t view = view_stride(), row = desc_.size[axis_u];
        const bool is_float = traits_of(desc_.type).is_float;
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
                    for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s) {
                        const std::size_t index =
                            std::size_t{t - slab.begin[axis_t]} * slab.extent()[axis_s] +
                            (s - slab.begin[axis_s]);
                        planes[index * view + v * row + u] =
                            structure_value(is_float, desc_.channels, texel);
                        texel += desc_.texel_bytes();
                    }
    }

    Status add_structure(const Box4& slab) {
        const Extent4 e = slab.extent();
        const std::uint64_t count = std::uint64_t{e[axis_s]} * e[axis_t];
        const SampleTraits& traits = traits_of(desc_.type);
        const double peak = traits.is_float ? pu21_peak : traits.largest_code;
        std::vector<double> values(count);
        TESSERA_TRY(for_each_index(count, threads_, [&](std::uint64_t i) {
            const std::size_t first = i * view_stride(), view = view_texels();
            values[i] = ssim(std::span(plane_a_).subspan(first, view),
                             std::span(plane_b_).subspan(first, view), desc_.size[axis_u],
                             desc_.size[axis_v], peak);
            return Status();
        }));
        for (std::uint64_t i = 0; i < count; ++i) {
            ssim_sum_ += values[i];
            if (result_.views++ == 0 || values[i] < result_.ssim_worst) {
                result_.ssim_worst = values[i];
                result_.worst_s = slab.begin[axis_s] + static_cast<std::uint32_t>(i % e[axis_s]);
                result_.worst_t = slab.begin[axis_t] + static_cast<std::uint32_t>(i / e[axis_s]);
            }
        }
        return {};
    }

    void advance(std::uint64_t texels) {
        if (!options_.progress)
            return;
        const std::lock_guard lock(progress_mutex_);
        done_ += texels;
        options_.progress("comparing", static_cast<double>(done_),
                          static_cast<double>(texel_count(desc_.size)));
    }

    TexelSource& a_;
    TexelSource& b_;
    TextureDesc desc_;
    const CompareOptions& options_;
    unsigned threads_ = 1;
    Comparison result_;
    double ssim_sum_ = 0;
    std::vector<float> plane_a_, plane_b_;
    std::mutex progress_mutex_;
    std::uint64_t done_ = 0;
};

} // namespace

double psnr_of(double mse, double peak) {
    return mse > 0 ? 10 * std::log10(peak * peak / mse) : std::numeric_limits<double>::infinity();
}

double pu21_encode(double luminance) {
    constexpr double p[7] = {0.353487901,   0.3734658629, 8.277049286e-05, 0.9062562627,
                             0.09150303166, 0.9099517204, 596.3148142};
    const double y = std::pow(std::clamp(luminance, 0.005, 10000.0), p[3]);
    return p[6] * (std::pow((p[0] + p[1] * y) / (1 + p[2] * y), p[4]) - p[5]);
}

void ErrorSums::add(const Box4& box, std::span<const std::byte> a, std::span<const std::byte> b,
                    std::span<const std::byte> matters) {
    switch (desc_.type) { // without default, so that the compiler names a type that is missing
    case SampleType::unorm8:
        add_unorm8(box, a.data(), b.data(), matters);
        break;
    case SampleType::half16:
        add_half16(box, a.data(), b.data(), matters);
        break;
    }
    texels_ += box.texels() - free_count(matters);
}

void ErrorSums::note_error(std::uint32_t error, const Box4& box, std::uint64_t texel,
                           unsigned channel) {
    ++differing_;
    if (error <= max_error_)
        return;
    const Extent4 e = box.extent();
    const auto take = [&](Axis axis) {
        const std::uint32_t i = static_cast<std::uint32_t>(texel % e[axis]);
        texel /= e[axis];
        return box.begin[axis] + i;
    };
    max_error_ = error;
    max_place_.s = take(axis_s);
    max_place_.t = take(axis_t);
    max_place_.u = take(axis_u);
    max_place_.v = take(axis_v);
    max_place_.channel = channel;
}

void ErrorSums::add_unorm8(const Box4& box, const std::byte* a, const std::byte* b,
                           std::span<const std::byte> matters) {
    const std::uint64_t texels = box.texels();
    const unsigned channels = desc_.channels;
    std::array<std::uint64_t, 4> squared{};
    std::uint64_t luma = 0;
    for (std::uint64_t i = 0; i < texels; ++i) {
        std::int64_t d[4] = {};
        for (unsigned c = 0; c < channels; ++c, ++a, ++b) {
            if (is_free(matters, i))
                continue;
            d[c] = std::to_integer<int>(*a) - std::to_integer<int>(*b);
            if (d[c] != 0)
                note_error(static_cast<std::uint32_t>(std::abs(d[c])), box, i, c);
            squared[c] += static_cast<std::uint64_t>(d[c] * d[c]);
        }
        const std::int64_t y = luma_r * d[0] + luma_g * d[1] + luma_b * d[2];
        luma += static_cast<std::uint64_t>(y * y); // below 2^63 for 2^20 texels
    }
    for (unsigned c = 0; c < channels; ++c)
        squared_[c] += static_cast<double>(squared[c]);
    luma_ += static_cast<double>(luma);
}

void ErrorSums::add_half16(const Box4& box, const std::byte* a, const std::byte* b,
                           std::span<const std::byte> matters) {
    const std::uint64_t texels = box.texels();
    std::array<std::uint64_t, 4> squared{};
    double log2_sum = 0, pu21_sum = 0;
    for (std::uint64_t i = 0; i < texels; ++i)
        for (unsigned c = 0; c < desc_.channels; ++c, a += 2, b += 2) {
            if (is_free(matters, i))
                continue;
            const std::uint16_t x = finite_half(load_le<std::uint16_t>(a), non_finite_[0]);
            const std::uint16_t y = finite_half(load_le<std::uint16_t>(b), non_finite_[1]);
            const std::int64_t d = std::int64_t{half_ordinal(x)} - half_ordinal(y);
            if (d == 0)
                continue;
            note_error(static_cast<std::uint32_t>(std::abs(d)), box, i, c);
            squared[c] += static_cast<std::uint64_t>(d * d);
            if (c >= colour_channels())
                continue;
            const double log2_error = log2_of_half(x) - log2_of_half(y);
            const double pu21_error = static_cast<double>(pu21_of_half(x) - pu21_of_half(y));
            log2_sum += log2_error * log2_error;
            pu21_sum += pu21_error * pu21_error;
        }
    for (unsigned c = 0; c < desc_.channels; ++c)
        squared_[c] += static_cast<double>(squared[c]);
    log2_ += log2_sum;
    pu21_ += pu21_sum;
}

void ErrorSums::merge(const ErrorSums& later) {
    texels_ += later.texels_;
    differing_ += later.differing_;
    for (std::size_t c = 0; c < 4; ++c)
        squared_[c] += later.squared_[c];
    luma_ += later.luma_;
    log2_ += later.log2_;
    pu21_ += later.pu21_;
    for (std::size_t i = 0; i < 2; ++i)
        non_finite_[i] += later.non_finite_[i];
    if (later.max_error_ > max_error_) {
        max_error_ = later.max_error_;
        max_place_ = later.max_place_;
    }
}

double ErrorSums::psnr() const {
    double sum = 0;
    for (unsigned c = 0; c < desc_.channels; ++c)
        sum += squared_[c];
    return psnr_of(sum / (static_cast<double>(texels_) * desc_.channels),
                   traits_of(desc_.type).largest_code);
}

double ErrorSums::psnr(unsigned channel) const {
    return psnr_of(squared_[channel] / static_cast<double>(texels_),
                   traits_of(desc_.type).largest_code);
}

double ErrorSums::psnr_luma() const {
    const SampleTraits& traits = traits_of(desc_.type);
    if (desc_.channels < 3 || traits.is_float)
        return psnr(0);
    const double one = static_cast<double>(luma_one * luma_one);
    return psnr_of(luma_ / one / static_cast<double>(texels_), traits.largest_code);
}

double ErrorSums::psnr_log2() const {
    return psnr_of(log2_ / (static_cast<double>(texels_) * colour_channels()), log2_peak);
}

double ErrorSums::psnr_pu21() const {
    return psnr_of(pu21_ / (static_cast<double>(texels_) * colour_channels()), pu21_peak);
}

double ssim(std::span<const float> a, std::span<const float> b, std::uint32_t width,
            std::uint32_t height, double peak) {
    const std::vector<float> across = gaussian_window(width), down = gaussian_window(height);
    const std::size_t columns = width - across.size() + 1, rows = height - down.size() + 1;
    const auto offset = static_cast<float>(peak / 2);
    const auto c1 = static_cast<float>(0.01 * peak * 0.01 * peak);
    const auto c2 = static_cast<float>(0.03 * peak * 0.03 * peak);
    // A ring of rows filtered across, as many as the window is high, and their weighted sum.
    std::vector<MomentRows> ring(down.size(), MomentRows(columns));
    MomentRows sums(columns);
    std::vector<float> line_a(width), line_b(width);
    double total = 0;
    for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t x = 0; x < width; ++x) {
            line_a[x] = a[y * width + x] - offset;
            line_b[x] = b[y * width + x] - offset;
        }
        filter_row(line_a.data(), line_b.data(), across, ring[y % ring.size()]);
        if (y + 1 < ring.size())
            continue;
        sums.clear();
        for (std::size_t k = 0; k < down.size(); ++k)
            add_rows(ring[(y + 1 + k) % ring.size()], down[k], sums);
        total += sum_of_row(sums, offset, c1, c2);
    }
    return total / (static_cast<double>(columns) * static_cast<double>(rows));
}

Status check_comparable(const TextureDesc& a, const TextureDesc& b) {
    const auto words = [](const TextureDesc& d) {
        return to_string(d.size) + ", " + std::to_string(d.channels) + " channels of " +
               traits_of(d.type).name;
    };
    if (a == b)
        return {};
    return {ErrorCode::difference,
            "the textures differ in size or samples: " + words(a) + " and " + words(b)};
}

Result<Comparison> compare_textures(TexelSource& a, TexelSource& b, const CompareOptions& options) {
    TESSERA_TRY(check_comparable(a.desc(), b.desc()));
    TESSERA_TRY(check_mask(options.mask, a.desc().size));
    return Comparer(a, b, options).run();
}

} // namespace tessera
