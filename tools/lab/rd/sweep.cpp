#include "tools/lab/rd/sweep.h"

#include "format/work.h"
#include "tools/support/interrupt.h"

#include <algorithm>

namespace tessera {
namespace {

// Part of the cache key. Increase it when the measurement changes, so that older results are not
// used.
constexpr int measuring_version = 1;

Json key_of(const RdTexture& texture, const CodecUnderTest& codec, const std::string& setting,
            const SweepOptions& options) {
    return {{"texture", texture.checksum},
            {"rendered", texture.window.has_value()},
            {"codec", codec.id},
            {"layout", codec.layout},
            {"version", codec.version},
            {"setting", setting},
            {"threads", thread_count(options.threads)},
            {"measuring", measuring_version}};
}

Result<ScratchFolder> folder_for(const RdTexture& texture, const std::string& codec,
                                 const std::string& setting, const SweepOptions& options) {
    if (options.keep_folder.empty())
        return ScratchFolder::create();
    std::string name = texture.label + "_" + codec + "_" + setting;
    for (char& c : name)
        if (c == ':' || c == ' ' || c == '/')
            c = '-';
    return ScratchFolder::keep(options.keep_folder + "/" + name);
}

double megabytes_per_second(const RdTexture& texture, double seconds) {
    return seconds > 0 ? static_cast<double>(texture.texels.size()) / 1e6 / seconds : 0;
}

Result<Measurement> measure(const RdTexture& texture, const CodecUnderTest& codec,
                            const std::string& setting, const SweepOptions& options,
                            const ProgressFunction& progress, QualityMeter& meter) {
    TESSERA_TRY_ASSIGN(const auto folder, folder_for(texture, codec.id, setting, options));
    const CodingJob job{texture, folder, options.threads, options.timeout, progress};
    TESSERA_TRY_ASSIGN(const auto coded, codec.run(job, setting));
    TESSERA_TRY_ASSIGN(const auto quality, meter.measure(coded.texels, progress));
    Measurement m;
    m.codec = codec.id;
    m.setting = setting;
    m.bytes = coded.bytes;
    m.bits_per_texel =
        static_cast<double>(coded.bytes) * 8 / static_cast<double>(texture.texel_count());
    m.quality = quality;
    m.encode_mbs = megabytes_per_second(texture, coded.encode_seconds);
    m.decode_mbs = megabytes_per_second(texture, coded.decode_seconds);
    m.texel_bytes = coded.texel_bytes;
    m.view_bytes = coded.view_bytes;
    m.note = coded.note;
    return m;
}

// Takes the measurement from the cache, or measures and stores it.
Result<Measurement> find_or_measure(const RdTexture& texture, const CodecUnderTest& codec,
                                    const std::string& setting, const SweepOptions& options,
                                    const ProgressFunction& progress, QualityMeter& meter) {
    const MeasurementCache cache(options.cache);
    const Json key = key_of(texture, codec, setting, options);
    if (auto known = cache.find(key))
        return *known;
    const auto measured = measure(texture, codec, setting, options, progress, meter);
    if (interrupted_by() != 0)
        return Status(ErrorCode::runtime, "interrupted; run the same command again to continue");
    if (!measured.ok()) {
        Measurement failure;
        failure.codec = codec.id;
        failure.setting = setting;
        failure.failed = measured.status().message();
        return failure;
    }
    TESSERA_TRY(cache.keep(key, *measured));
    return measured;
}

// Measures one codec at as many settings as its curve needs.
class CodecSweep {
public:
    using Measure = std::function<Result<Measurement>(const std::string& setting)>;
    CodecSweep(const CodecUnderTest& codec, const SweepOptions& options, const Measure& measure)
        : codec_(codec), options_(options), measure_(measure) {}

    // Measures the usual settings, then coarser and finer ones until the curve covers the range.
    Status run() {
        for (const std::string& setting : codec_.settings)
            TESSERA_TRY(add(setting));
        for (const std::string& setting : codec_.coarser)
            if (low_ < high_ && low_ > options_.low_psnr)
                TESSERA_TRY(add(setting));
        for (const std::string& setting : codec_.finer)
            if (low_ <= high_ && high_ < options_.high_psnr)
                TESSERA_TRY(add(setting));
        std::stable_sort(rows_.begin(), rows_.end(),
                         [](const Measurement& a, const Measurement& b) {
                             return a.bits_per_texel < b.bits_per_texel;
                         });
        return {};
    }
    const std::vector<Measurement>& rows() const { return rows_; }

private:
    Status add(const std::string& setting) {
        TESSERA_TRY_ASSIGN(const auto m, measure_(setting));
        rows_.push_back(m);
        if (!m.failed.empty())
            return {};
        low_ = std::min(low_, m.quality.psnr_rgb);
        high_ = std::max(high_, m.quality.psnr_rgb);
        return {};
    }

    const CodecUnderTest& codec_;
    const SweepOptions& options_;
    const Measure& measure_;
    std::vector<Measurement> rows_;
    double low_ = 1e300, high_ = -1e300; // lowest and highest PSNR so far, dB
};

// Sets the range that the other curves should cover to that of the first codec, Tessera, without a
// tenth at each end. A texture that is hard to code may not reach the usual PSNRs at all.
void aim_at(const std::vector<Measurement>& ours, SweepOptions& options) {
    double low = 1e300, high = -1e300;
    for (const Measurement& m : ours) {
        if (!m.failed.empty())
            continue;
        low = std::min(low, m.quality.psnr_rgb);
        high = std::max(high, m.quality.psnr_rgb);
    }
    if (low >= high)
        return;
    const double margin = (high - low) / 10;
    options.low_psnr = low + margin;
    options.high_psnr = high - margin;
}

} // namespace

Result<std::vector<Measurement>>
sweep(const RdTexture& texture, const std::vector<CodecUnderTest>& codecs, SweepOptions options) {
    QualityMeter meter(texture, options.threads);
    std::size_t count = 0, number = 0; // count grows when coarser or finer settings are needed
    for (const CodecUnderTest& codec : codecs)
        count += codec.settings.size();
    std::vector<Measurement> all;
    for (const CodecUnderTest& codec : codecs) {
        std::size_t usual = codec.settings.size();
        const CodecSweep::Measure measure_setting = [&](const std::string& setting) {
            ++number;
            count += usual > 0 ? (--usual, 0) : 1;
            const ProgressFunction progress =
                options.progress ? options.progress(number, count, codec.id + " " + setting)
                                 : ProgressFunction();
            auto m = find_or_measure(texture, codec, setting, options, progress, meter);
            if (m.ok() && options.done)
                options.done(*m, number, count);
            return m;
        };
        CodecSweep codec_sweep(codec, options, measure_setting);
        TESSERA_TRY(codec_sweep.run());
        if (all.empty())
            aim_at(codec_sweep.rows(), options);
        all.insert(all.end(), codec_sweep.rows().begin(), codec_sweep.rows().end());
    }
    return all;
}

} // namespace tessera
