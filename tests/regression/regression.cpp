// Measures rate, distortion, speed and access cost, and writes a row per encode to results.csv:
//   regression results.csv [--quick]
// Sizes, PSNR and errors are reproducible, and the caller compares them. Speeds depend on the
// machine's load, so only ratios within a run count.
#include "codec/encoder.h"
#include "format/texture.h"
#include "tests/regression/textures.h"
#include "tools/lab/rd/access_cost.h"

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

using namespace tessera;

namespace {

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

struct Row {
    std::string texture, target;
    int effort;
    EncodeReport report;
    double encode_mbs, decode_mbs;
    std::size_t texel_reads;
    std::uint64_t texel_bytes; // of the last read, which is the tile
};

Result<Row> measure(const Texture& texture, const std::string& label, RateTarget rate, int effort) {
    EncodeOptions options;
    options.rate = rate;
    options.effort = effort;
    std::vector<std::byte> file;
    MemorySource texels_in_memory(texture.desc, texture.texels);
    const auto report = encode_memory(texels_in_memory, file, options);
    if (!report)
        return report.status();
    Row row{texture.name, label, effort, *report, 0, 0, 0, 0};
    const double raw = static_cast<double>(report->raw_bytes);
    row.encode_mbs = raw * report->passes / report->seconds / 1e6;

    const auto source = wrap_memory(file);
    auto decoder = Decoder::open(*source);
    if (!decoder)
        return decoder.status();
    const Extent4& size = decoder->desc().size;
    Box4 texel{{size[0] / 2, size[1] / 3, size[2] / 2, size[3] / 2}, {}};
    for (int axis = 0; axis < 4; ++axis)
        texel.end[axis] = texel.begin[axis] + 1;
    const auto access = access_cost(file, texel);
    if (!access)
        return access.status();
    row.texel_reads = access->first_reads;
    row.texel_bytes = access->bytes;

    std::vector<std::byte> texels(report->raw_bytes);
    double best = 1e9;
    for (int i = 0; i < 5; ++i) {
        const double start = seconds();
        TESSERA_TRY(decoder->decode_box(Box4::whole(size), texels));
        best = std::min(best, seconds() - start);
    }
    row.decode_mbs = raw / best / 1e6;
    return row;
}

void print(std::FILE* to, const Row& r) {
    std::fprintf(to, "%s,%s,%d,%llu,%.5f,%.3f,%.0f,%.1f,%.1f,%zu,%llu\n", r.texture.c_str(),
                 r.target.c_str(), r.effort, static_cast<unsigned long long>(r.report.file_bytes),
                 r.report.bits_per_texel, r.report.psnr, r.report.max_error, r.encode_mbs,
                 r.decode_mbs, r.texel_reads, static_cast<unsigned long long>(r.texel_bytes));
    std::fflush(to);
}

int fail(const Status& status) {
    std::fprintf(stderr, "regression: error: %s\n", status.message().c_str());
    return static_cast<int>(status.code());
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: regression results.csv [--quick]\n");
        return 1;
    }
    const bool quick = argc > 2 && std::string(argv[2]) == "--quick";
    std::FILE* csv = std::fopen(argv[1], "w");
    if (csv == nullptr)
        return fail({ErrorCode::io, std::string("cannot write ") + argv[1]});
    const char* heading = "texture,target,effort,bytes,bits_per_texel,psnr,max_error,encode_MBps,"
                          "decode_MBps,reads_for_one_texel,bytes_of_last_read\n";
    std::fputs(heading, csv);
    std::fputs(heading, stdout);
    const auto add = [csv](const Texture& texture, const std::string& label, RateTarget rate,
                           int effort) {
        const Result<Row> row = measure(texture, label, rate, effort);
        if (!row)
            return fail(row.status());
        print(csv, *row);
        print(stdout, *row);
        return 0;
    };
    using Kind = RateTarget::Kind;
    // The texture of the comparisons with other codecs (rd_composed.md).
    Result<Texture> composed = bake("composed", {128, 64, 32, 32});
    if (!composed)
        return fail(composed.status());
    for (const double psnr : {35.0, 38.0, 41.0})
        if (const int bad = add(*composed, "psnr" + std::to_string(static_cast<int>(psnr)),
                                {Kind::psnr, psnr}, usual_effort))
            return bad;
    for (int effort = 0; effort <= most_effort; effort += quick ? 3 : 1)
        if (const int bad = add(*composed, "quality62", {Kind::quality, 62}, effort))
            return bad;
    if (!quick) {
        for (const double error : {0.0, 1.0, 4.0})
            if (const int bad =
                    add(*composed, "max_error" + std::to_string(static_cast<int>(error)),
                        {Kind::max_error, error}, usual_effort))
                return bad;
        for (const char* scene : {"composed", "aliasing-near", "aliasing-far", "gallery", "mirror",
                                  "lamps", "lambert", "hard"}) {
            Result<Texture> texture = bake(scene, {64, 32, 16, 16});
            if (!texture)
                return fail(texture.status());
            for (const double quality : {50.0, 62.0, 75.0})
                if (const int bad =
                        add(*texture, "quality" + std::to_string(static_cast<int>(quality)),
                            {Kind::quality, quality}, usual_effort))
                    return bad;
        }
    }
    std::fclose(csv);
    return 0;
}
