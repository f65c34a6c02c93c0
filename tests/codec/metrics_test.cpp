// The metrics compared with slow implementations of their definitions.
#include "codec/metrics.h"
#include "format/io/bytes.h"
#include "format/samples.h"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <random>

namespace tessera {
namespace {

// A texture in memory that refuses reads outside the current slab.
class MemoryTexture : public TexelSource {
public:
    explicit MemoryTexture(const TextureDesc& desc)
        : desc_(desc), texels_(desc.box_bytes(Box4::whole(desc.size))) {}
    const TextureDesc& desc() const override { return desc_; }
    Status begin_slab(const Box4& box) override {
        slab_ = box;
        return {};
    }
    Status read(const Box4& box, std::span<std::byte> out) override {
        if (intersect(box, slab_) != box)
            return {ErrorCode::runtime, "outside the slab"};
        std::byte* to = out.data();
        const std::size_t n = desc_.texel_bytes();
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
                    for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s, to += n)
                        std::memcpy(to, at(u, v, s, t), n);
        return {};
    }
    std::byte* at(std::size_t u, std::size_t v, std::size_t s, std::size_t t) {
        const Extent4& e = desc_.size;
        return texels_.data() +
               (((v * e[axis_u] + u) * e[axis_t] + t) * e[axis_s] + s) * desc_.texel_bytes();
    }
    double value(std::size_t sample) const {
        if (desc_.type == SampleType::unorm8)
            return std::to_integer<int>(texels_[sample]);
        return half_to_float(load_le<std::uint16_t>(texels_.data() + 2 * sample));
    }
    std::size_t samples() const { return texels_.size() / sample_bytes(desc_.type); }
    std::vector<std::byte>& bytes() { return texels_; }

private:
    TextureDesc desc_;
    Box4 slab_;
    std::vector<std::byte> texels_;
};

struct Pair {
    MemoryTexture a, b;
    explicit Pair(const TextureDesc& desc, unsigned seed = 1) : a(desc), b(desc) {
        std::mt19937 random(seed);
        if (desc.type == SampleType::unorm8) {
            for (std::size_t i = 0; i < a.bytes().size(); ++i) {
                const int x = static_cast<int>(random() % 256);
                const int y = std::clamp(x + static_cast<int>(random() % 41) - 20, 0, 255);
                a.bytes()[i] = std::byte(x);
                b.bytes()[i] = std::byte(y);
            }
            return;
        }
        std::uniform_real_distribution<float> stops(-12, 12), noise(-0.2f, 0.2f);
        for (std::size_t i = 0; i < a.samples(); ++i) {
            const float x = std::exp2(stops(random)) - 0.001f, y = x * std::exp2(noise(random));
            store_le(a.bytes().data() + 2 * i, float_to_half(x));
            store_le(b.bytes().data() + 2 * i, float_to_half(y));
        }
    }
    Result<Comparison> compare(unsigned threads = 2, std::uint64_t slab_bytes = 64 << 20) {
        CompareOptions options;
        options.threads = threads;
        options.slab_bytes = slab_bytes;
        return compare_textures(a, b, options);
    }
};

double naive_psnr(const Pair& pair, std::size_t first, std::size_t step, double peak,
                  double (*map)(double)) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = first; i < pair.a.samples(); i += step, ++count) {
        const double d = map(pair.a.value(i)) - map(pair.b.value(i));
        sum += d * d;
    }
    return 10 * std::log10(peak * peak * static_cast<double>(count) / sum);
}

// SSIM as the paper defines it, with a two-dimensional window in double precision.
double naive_ssim(const std::vector<double>& a, const std::vector<double>& b, int width, int height,
                  double peak) {
    const int nx = std::min(width, 11), ny = std::min(height, 11);
    std::vector<double> window;
    double total = 0;
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) {
            const double dx = x - (nx - 1) / 2.0, dy = y - (ny - 1) / 2.0;
            window.push_back(std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5)));
            total += window.back();
        }
    const double c1 = std::pow(0.01 * peak, 2), c2 = std::pow(0.03 * peak, 2);
    double sum = 0;
    for (int y0 = 0; y0 + ny <= height; ++y0)
        for (int x0 = 0; x0 + nx <= width; ++x0) {
            double ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
            const auto each = [&](auto visit) {
                for (int y = 0; y < ny; ++y)
                    for (int x = 0; x < nx; ++x) {
                        const auto i = static_cast<std::size_t>((y0 + y) * width + x0 + x);
                        visit(window[static_cast<std::size_t>(y * nx + x)] / total, a[i], b[i]);
                    }
            };
            each([&](double w, double p, double q) {
                ma += w * p;
                mb += w * q;
            });
            each([&](double w, double p, double q) {
                va += w * (p - ma) * (p - ma);
                vb += w * (q - mb) * (q - mb);
                cov += w * (p - ma) * (q - mb);
            });
            sum +=
                (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
        }
    return sum / ((width - nx + 1) * (height - ny + 1));
}

double identity(double x) {
    return x;
}
double log2_map(double x) {
    return std::log2(std::max(x, 1e-4));
}
double pu21_map(double x) {
    return pu21_encode(100 * x);
}

double luma8(const std::byte* rgb) {
    const auto c = [&](int i) { return std::to_integer<int>(rgb[i]); };
    return 0.2126 * c(0) + 0.7152 * c(1) + 0.0722 * c(2);
}

TEST(Metrics, Pu21HasTheAuthorsValues) {
    EXPECT_NEAR(pu21_encode(100), 256, 1);
    EXPECT_NEAR(pu21_encode(0.005), 0, 1e-3);
    EXPECT_NEAR(pu21_encode(10000), 595.39, 0.01);
    EXPECT_EQ(pu21_encode(0), pu21_encode(0.005));
    EXPECT_EQ(pu21_encode(1e9), pu21_encode(10000));
    EXPECT_NEAR(log2_peak, std::log2(65504 / log2_floor), 1e-9);
}

TEST(Metrics, PsnrOfEightBits) {
    for (std::uint8_t channels = 1; channels <= 4; ++channels) {
        Pair pair({{37, 21, 5, 3}, SampleType::unorm8, channels});
        const auto c = pair.compare();
        ASSERT_TRUE(c.ok()) << c.status().message();
        EXPECT_EQ(c->errors.texels(), 37u * 21 * 5 * 3);
        EXPECT_NEAR(c->errors.psnr(), naive_psnr(pair, 0, 1, 255, identity), 1e-9);
        for (unsigned i = 0; i < channels; ++i)
            EXPECT_NEAR(c->errors.psnr(i), naive_psnr(pair, i, channels, 255, identity), 1e-9);
        if (channels < 3) {
            EXPECT_EQ(c->errors.psnr_luma(), c->errors.psnr(0));
            continue;
        }
        double sum = 0;
        for (std::size_t i = 0; i < pair.a.samples(); i += channels)
            sum += std::pow(luma8(pair.a.bytes().data() + i) - luma8(pair.b.bytes().data() + i), 2);
        const double mse = sum / static_cast<double>(pair.a.samples() / channels);
        EXPECT_NEAR(c->errors.psnr_luma(), 10 * std::log10(255 * 255 / mse), 1e-9);
    }
}

TEST(Metrics, PsnrOfHalves) {
    Pair pair({{19, 11, 5, 3}, SampleType::half16, 3});
    const auto c = pair.compare();
    ASSERT_TRUE(c.ok()) << c.status().message();
    EXPECT_NEAR(c->errors.psnr_log2(), naive_psnr(pair, 0, 1, log2_peak, log2_map), 1e-4);
    EXPECT_NEAR(c->errors.psnr_pu21(), naive_psnr(pair, 0, 1, 256, pu21_map), 1e-3);
    const auto code = [](double x) {
        return static_cast<double>(half_ordinal(float_to_half(static_cast<float>(x))));
    };
    EXPECT_NEAR(c->errors.psnr(), naive_psnr(pair, 0, 1, 31743, code), 1e-9);
}

TEST(Metrics, OrdinalsCountUlps) {
    EXPECT_EQ(half_ordinal(0), 0);
    EXPECT_EQ(half_ordinal(0x8000), 0);
    for (std::uint32_t h = 0; h < 0x7C00; ++h)
        EXPECT_EQ(half_ordinal(static_cast<std::uint16_t>(h | 0x8000)),
                  -half_ordinal(static_cast<std::uint16_t>(h)));
}

TEST(Metrics, NonFiniteHalvesFollowTheCodecsPolicy) {
    Pair pair({{3, 2, 2, 2}, SampleType::half16, 1});
    pair.b.bytes() = pair.a.bytes();
    const std::uint16_t in[4] = {0x7E00, 0x7C00, 0xFC00, 0xFE01};
    const std::uint16_t out[4] = {0x0000, 0x7BFF, 0xFBFF, 0x8000};
    for (int i = 0; i < 4; ++i) {
        store_le(pair.a.bytes().data() + 2 * i, in[i]);
        store_le(pair.b.bytes().data() + 2 * i, out[i]);
    }
    const auto c = pair.compare();
    ASSERT_TRUE(c.ok());
    EXPECT_EQ(c->errors.differing_samples(), 0u);
    EXPECT_EQ(c->errors.non_finite(0), 4u);
    EXPECT_EQ(c->errors.non_finite(1), 0u);
    EXPECT_TRUE(std::isinf(c->errors.psnr_pu21()));
}

TEST(Metrics, FindsTheLargestError) {
    Pair pair({{40, 34, 9, 5}, SampleType::unorm8, 3});
    pair.b.bytes() = pair.a.bytes();
    pair.a.at(33, 32, 7, 4)[2] = std::byte{255};
    pair.b.at(33, 32, 7, 4)[2] = std::byte{3};
    pair.b.at(1, 1, 1, 1)[0] = std::byte(std::to_integer<int>(pair.a.at(1, 1, 1, 1)[0]) ^ 1);
    for (const std::uint64_t slab : {std::uint64_t{64} << 20, std::uint64_t{20000}}) {
        const auto c = pair.compare(2, slab);
        ASSERT_TRUE(c.ok());
        EXPECT_EQ(c->errors.max_error(), 252u);
        EXPECT_EQ(c->errors.max_error_place(), (SamplePlace{33, 32, 7, 4, 2}));
        EXPECT_EQ(c->errors.differing_samples(), 2u);
    }
}

TEST(Metrics, SsimMatchesTheNaiveOne) {
    for (const auto& [w, h] : {std::pair(32, 24), {11, 11}, {5, 40}, {10, 3}, {1, 1}}) {
        std::mt19937 random(3);
        std::vector<double> a, b;
        for (int i = 0; i < w * h; ++i) {
            a.push_back(std::round(128 + 100 * std::sin(i * 0.7) * std::cos(i / w * 0.3)));
            b.push_back(std::clamp(a.back() + static_cast<double>(random() % 31) - 15, 0.0, 255.0));
        }
        const std::vector<float> fa(a.begin(), a.end()), fb(b.begin(), b.end());
        const auto width = static_cast<std::uint32_t>(w), height = static_cast<std::uint32_t>(h);
        EXPECT_NEAR(ssim(fa, fb, width, height, 255), naive_ssim(a, b, w, h, 255), 2e-5);
        EXPECT_EQ(ssim(fa, fa, width, height, 255), 1);
    }
}

TEST(Metrics, SsimOverViews) {
    Pair pair({{25, 17, 3, 2}, SampleType::unorm8, 3});
    double sum = 0, worst = 2;
    for (std::uint32_t t = 0; t < 2; ++t)
        for (std::uint32_t s = 0; s < 3; ++s) {
            std::vector<double> a, b;
            for (std::uint32_t v = 0; v < 17; ++v)
                for (std::uint32_t u = 0; u < 25; ++u) {
                    a.push_back(std::floor(luma8(pair.a.at(u, v, s, t)) + 0.5));
                    b.push_back(std::floor(luma8(pair.b.at(u, v, s, t)) + 0.5));
                }
            const double value = naive_ssim(a, b, 25, 17, 255);
            sum += value;
            worst = std::min(worst, value);
        }
    const auto c = pair.compare();
    ASSERT_TRUE(c.ok());
    EXPECT_EQ(c->views, 6u);
    EXPECT_NEAR(c->ssim_mean, sum / 6, 2e-5);
    EXPECT_NEAR(c->ssim_worst, worst, 2e-5);
}

TEST(Metrics, SsimOfHalvesIsOverPu21) {
    for (const std::uint8_t channels : {1, 3}) { // colours are compared by their luminance
        Pair pair({{14, 13, 1, 1}, SampleType::half16, channels});
        pair.b.bytes() = Pair(pair.a.desc(), 2).a.bytes(); // different, as equal ones give 1
        const auto pictured = [&](const MemoryTexture& texture) {
            std::vector<double> values;
            for (std::size_t i = 0; i < texture.samples(); i += channels) {
                const auto at = [&](std::size_t c) { return texture.value(i + c); };
                values.push_back(pu21_map(
                    channels < 3 ? at(0) : 0.2126 * at(0) + 0.7152 * at(1) + 0.0722 * at(2)));
            }
            return values;
        };
        const auto c = pair.compare();
        ASSERT_TRUE(c.ok());
        EXPECT_NEAR(c->ssim_mean, naive_ssim(pictured(pair.a), pictured(pair.b), 14, 13, 256), 1e-4)
            << +channels;
    }
}

TEST(Metrics, DoNotDependOnThreads) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        Pair pair({{45, 37, 9, 4}, type, 3});
        const auto one = pair.compare(1, 100000), many = pair.compare(7, 100000);
        ASSERT_TRUE(one.ok() && many.ok());
        EXPECT_EQ(one->errors.psnr(), many->errors.psnr());
        EXPECT_EQ(one->errors.psnr_luma(), many->errors.psnr_luma());
        EXPECT_EQ(one->errors.psnr_log2(), many->errors.psnr_log2());
        EXPECT_EQ(one->errors.psnr_pu21(), many->errors.psnr_pu21());
        EXPECT_EQ(one->errors.max_error_place(), many->errors.max_error_place());
        EXPECT_EQ(one->ssim_mean, many->ssim_mean);
        EXPECT_EQ(one->ssim_worst, many->ssim_worst);
        EXPECT_TRUE(one->has_ssim);
    }
}

TEST(Metrics, RefusesTexturesOfDifferentKinds) {
    MemoryTexture a({{4, 4, 2, 2}, SampleType::unorm8, 3}),
        b({{4, 4, 2, 3}, SampleType::unorm8, 3});
    const auto c = compare_textures(a, b);
    EXPECT_EQ(c.status().code(), ErrorCode::difference);
    EXPECT_NE(c.status().message().find("4x4x2x3"), std::string::npos);
}

TEST(Metrics, OneTexel) {
    Pair pair({{1, 1, 1, 1}, SampleType::unorm8, 1});
    pair.b.bytes() = pair.a.bytes();
    const auto c = pair.compare();
    ASSERT_TRUE(c.ok());
    EXPECT_TRUE(std::isinf(c->errors.psnr()));
    EXPECT_EQ(c->ssim_mean, 1);
}

} // namespace
} // namespace tessera
