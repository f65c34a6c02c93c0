// Times encoding and decoding of a raw 8-bit RGB texture in memory, on one thread, by CPU time.
// Prints a row of a table for each quality.
//   codec_speed TEXTURE.rgb UxVxSxT EFFORT QUALITY...
// It uses only what old revisions have as well. To time one, compile this file in its tree:
//   g++ -std=c++20 -O2 -I. codec_speed.cpp -Lbuild/codec -Lbuild/format -ltessera_codec
//       -ltessera_decoder -ltessera_format -ldraco -lzstd
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "format/texture.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <vector>

using namespace tessera;

namespace {

constexpr int decodes = 25; // of which the fastest counts

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Status measure(const char* name, const TextureDesc& desc, const std::vector<std::byte>& texels,
               int effort, double quality) {
    MemorySource source(desc, texels);
    EncodeOptions options;
    options.rate = {RateTarget::Kind::quality, quality};
    options.effort = effort;
    options.threads = 1;
    std::vector<std::byte> file, decoded(texels.size());
    const double begun = cpu_seconds();
    const auto report = encode_memory(source, file, options);
    if (!report)
        return report.status();
    const double encoding = cpu_seconds() - begun;
    double decoding = 1e9;
    for (int i = 0; i < decodes; ++i) {
        const double start = cpu_seconds();
        const auto bytes = wrap_memory(file);
        const auto decoder = Decoder::open(*bytes);
        if (!decoder)
            return decoder.status();
        TESSERA_TRY(decoder->decode_box(Box4::whole(desc.size), decoded, {.threads = 1}));
        decoding = std::min(decoding, cpu_seconds() - start);
    }
    const double megabytes = static_cast<double>(texels.size()) / 1e6;
    std::printf("| %s | %g | %zu | %.2f | %.2f | %.0f |\n", name, quality, file.size(),
                report->psnr, megabytes / encoding, megabytes / decoding);
    std::fflush(stdout);
    return {};
}

Status run(int argc, char** argv) {
    TextureDesc desc{{}, SampleType::unorm8, 3};
    Extent4& n = desc.size;
    if (argc < 5 || std::sscanf(argv[2], "%ux%ux%ux%u", &n[0], &n[1], &n[2], &n[3]) != 4)
        return {ErrorCode::bad_argument,
                "usage: codec_speed TEXTURE.rgb UxVxSxT EFFORT QUALITY..."};
    std::vector<std::byte> texels(desc.box_bytes(Box4::whole(n)));
    std::ifstream file(argv[1], std::ios::binary);
    if (!file.read(reinterpret_cast<char*>(texels.data()),
                   static_cast<std::streamsize>(texels.size())))
        return {ErrorCode::io, std::string(argv[1]) + ": cannot be read or is too short"};
    std::puts("| texture | quality | bytes | dB | encoding MB/s | decoding MB/s |\n"
              "|---|---|---|---|---|---|");
    for (int i = 4; i < argc; ++i)
        TESSERA_TRY(measure(argv[1], desc, texels, std::atoi(argv[3]), std::atof(argv[i])));
    return {};
}

} // namespace

int main(int argc, char** argv) {
    const Status status = run(argc, argv);
    if (!status.ok())
        std::fprintf(stderr, "codec_speed: error: %s\n", status.message().c_str());
    return static_cast<int>(status.code());
}
