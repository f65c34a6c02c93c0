#include "tools/lab/rd/tessera_codec.h"

#include "codec/decoder.h"
#include "format/metadata.h"
#include "format/texture.h"
#include "tools/lab/rd/access_cost.h"
#include "tools/lab/rd/rivals.h" // best_time
#include "tools/support/checksum.h"
#include "tools/support/interrupt.h"
#include "tools/support/output_folders.h"

#include <chrono>
#include <cstdio>

namespace tessera {
namespace {

// How many texels and views the access cost is averaged over.
constexpr std::size_t texel_probes = 64, view_probes = 8;

// The version is part of the cache key. It contains a checksum of the program, because two builds
// of one version may encode differently.
std::string build_version() {
    static const std::string version = [] {
        const auto program = bytes_in_file("/proc/self/exe");
        char crc[16] = "";
        if (program.ok())
            std::snprintf(crc, sizeof crc, " %08x", checksum(*program));
        return std::string(library_version) + crc;
    }();
    return version;
}

// Point i of a low-discrepancy sequence, the multiples of irrational steps (Roberts' R4).
Extent4 probe(const Extent4& size, std::size_t i) {
    constexpr double step[4] = {0.8566748838545029, 0.7338918566271260, 0.6287067210378087,
                                0.5385972572236101};
    Extent4 place;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        const double x = step[axis] * static_cast<double>(i + 1);
        place[axis] = static_cast<std::uint32_t>((x - static_cast<double>(static_cast<long>(x))) *
                                                 size[axis]);
    }
    return place;
}

Box4 box_of(const Extent4& place, const Extent4& size, bool whole_view) {
    Box4 box;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        const bool all = whole_view && (axis == axis_u || axis == axis_v);
        box.begin[axis] = all ? 0 : place[axis];
        box.end[axis] = all ? size[axis] : place[axis] + 1;
    }
    return box;
}

Result<double> mean_access(std::span<const std::byte> file, const Extent4& size, bool whole_view) {
    const std::size_t probes = whole_view ? view_probes : texel_probes;
    double sum = 0;
    for (std::size_t i = 0; i < probes; ++i) {
        TESSERA_TRY_ASSIGN(const auto cost,
                           access_cost(file, box_of(probe(size, i), size, whole_view)));
        sum += static_cast<double>(cost.bytes);
    }
    return sum / static_cast<double>(probes);
}

RateTarget rate_of(const std::string& setting) {
    const double value = std::stod(setting.substr(setting.find(' ') + 1));
    return {setting.starts_with("psnr") ? RateTarget::Kind::psnr : RateTarget::Kind::quality,
            value};
}

Result<double> decode(std::span<const std::byte> file, unsigned threads,
                      std::vector<std::byte>& texels) {
    const auto begun = std::chrono::steady_clock::now();
    const auto bytes = wrap_memory(file);
    TESSERA_TRY_ASSIGN(const auto decoder, Decoder::open(*bytes));
    TESSERA_TRY(decoder.decode_box(Box4::whole(decoder.desc().size), texels, {.threads = threads}));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

Result<Coded> code(int effort, const CodingJob& job, const std::string& setting) {
    EncodeOptions options;
    options.rate = rate_of(setting);
    options.effort = effort;
    options.threads = job.threads;
    options.progress = job.progress;
    const auto source =
        interruptible(std::make_unique<MemorySource>(job.texture.desc, job.texture.texels));
    std::vector<std::byte> file;
    TESSERA_TRY_ASSIGN(const auto report, encode_memory(*source, file, options));
    TESSERA_TRY(write_bytes(job.folder.at("texture.tess"), file));
    Coded coded;
    coded.bytes = file.size();
    // Reaching a rate target takes several passes. The reported speed is that of one pass, because
    // rivals also run one pass.
    coded.encode_seconds = report.seconds / std::max(1u, report.passes);
    coded.note = report.passes > 1 ? std::to_string(report.passes) + " passes" : "";
    coded.texels.resize(job.texture.texels.size());
    TESSERA_TRY_ASSIGN(coded.decode_seconds,
                       best_time([&] { return decode(file, job.threads, coded.texels); }));
    for (const bool whole_view : {false, true}) {
        TESSERA_TRY_ASSIGN(const auto bytes, mean_access(file, job.texture.desc.size, whole_view));
        (whole_view ? coded.view_bytes : coded.texel_bytes) = bytes;
    }
    return coded;
}

} // namespace

CodecUnderTest tessera_codec(int effort, std::vector<std::string> settings) {
    CodecUnderTest codec;
    codec.id = "tessera:" + std::to_string(effort);
    codec.layout = "effort " + std::to_string(effort) + ", independently decodable tiles";
    codec.version = "tessera " + build_version();
    codec.settings = std::move(settings);
    codec.run = [effort](const CodingJob& job, const std::string& setting) {
        return code(effort, job, setting);
    };
    return codec;
}

} // namespace tessera
