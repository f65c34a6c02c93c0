#include "tools/rd/sweep.h"

#include "tools/interrupt.h"
#include "tools/parallel.h"

#include <algorithm>

namespace tessera {
namespace {

// Grows when the way of measuring changes, so that older results are not mixed in.
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
    return static_cast<double>(texture.texels.size()) / 1e6 / std::max(seconds, 1e-9);
}

Result<Measurement> measure(const RdTexture& texture, const CodecUnderTest& codec,
                            const std::string& setting, const SweepOptions& options,
                            const ProgressFunction& progress, QualityMeter& meter) {
    const auto folder = folder_for(texture, codec.id, setting, options);
    if (!folder.ok())
        return folder.status();
    const CodingJob job{texture, *folder, options.threads, options.timeout, progress};
    const auto coded = codec.run(job, setting);
    if (!coded.ok())
        return coded.status();
    const auto quality = meter.measure(coded->texels, progress);
    if (!quality.ok())
        return quality.status();
    Measurement m;
    m.codec = codec.id;
    m.setting = setting;
    m.bytes = coded->bytes;
    m.bits_per_texel =
        static_cast<double>(coded->bytes) * 8 / static_cast<double>(texture.texel_count());
    m.quality = *quality;
    m.encode_mbs = megabytes_per_second(texture, coded->encode_seconds);
    m.decode_mbs = megabytes_per_second(texture, coded->decode_seconds);
    m.texel_bytes = coded->texel_bytes;
    m.view_bytes = coded->view_bytes;
    m.note = coded->note;
    return m;
}

// From the cache, or measured now and kept.
Result<Measurement> find_or_measure(const RdTexture& texture, const CodecUnderTest& codec,
                                    const std::string& setting, const SweepOptions& options,
                                    const ProgressFunction& progress, QualityMeter& meter) {
    const MeasurementCache cache(options.cache);
    const Json key = key_of(texture, codec, setting, options);
    if (auto known = cache.find(key))
        return *known;
    const auto measured = measure(texture, codec, setting, options, progress, meter);
    if (interrupted_by() != 0)
        return Status(ErrorCode::runtime, "interrupted; the same command goes on from here");
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

} // namespace

Result<std::vector<Measurement>> sweep(const RdTexture& texture,
                                       const std::vector<CodecUnderTest>& codecs,
                                       const SweepOptions& options) {
    QualityMeter meter(texture, options.threads);
    std::size_t count = 0;
    for (const CodecUnderTest& codec : codecs)
        count += codec.settings.size();
    std::vector<Measurement> all;
    for (const CodecUnderTest& codec : codecs)
        for (const std::string& setting : codec.settings) {
            const std::size_t number = all.size() + 1;
            const ProgressFunction progress =
                options.progress ? options.progress(number, count, codec.id + " " + setting)
                                 : ProgressFunction();
            const auto m = find_or_measure(texture, codec, setting, options, progress, meter);
            if (!m.ok())
                return m.status();
            all.push_back(*m);
            if (options.done)
                options.done(*m, number, count);
        }
    return all;
}

} // namespace tessera
