// The C++ example of README.md as a program; tests/check_readme.cmake compares and runs it.
//   readme_cpp FILE.tess          reads a box of the file
//   readme_cpp FILE.tess write    writes the file first, from a gradient
// [readme]
#include <tessera/codec/decoder.h>
#include <tessera/codec/encoder.h>
using namespace tessera;

Result<EncodeReport> encode(std::span<const std::byte> texels, const std::string& path) {
    MemorySource source({{64, 32, 16, 16}, SampleType::unorm8, 3}, texels); // order v, u, t, s
    EncodeOptions options;
    options.rate = {RateTarget::Kind::psnr, 40};
    return encode_file(source, path, options);
}

Result<std::vector<std::byte>> read_box(const std::string& path) {
    TESSERA_TRY_ASSIGN(const Decoder decoder, Decoder::open_file(path)); // or returns its error
    const Box4 box{{0, 0, 0, 0}, {16, 16, 8, 8}};                        // u, v, s, t
    std::vector<std::byte> texels(decoder.desc().box_bytes(box));
    TESSERA_TRY(decoder.decode_box(box, texels)); // reads only the tiles that the box touches
    return texels;
}
// [/readme]

#include <cstdio>

namespace {

std::vector<std::byte> gradient() {
    std::vector<std::byte> texels;
    for (int v = 0; v < 32; ++v)
        for (int u = 0; u < 64; ++u)
            for (int t = 0; t < 16; ++t)
                for (int s = 0; s < 16; ++s)
                    for (const int value : {3 * u + s, 6 * v + t, 4 * (s + t)})
                        texels.push_back(static_cast<std::byte>(value));
    return texels;
}

int fail(const Status& status) {
    std::fprintf(stderr, "error: %s\n", status.message().c_str());
    return static_cast<int>(status.code());
}

} // namespace

int main(int argc, char** argv) {
    const std::string path = argc > 1 ? argv[1] : "readme.tess";
    if (argc > 2) {
        const auto report = encode(gradient(), path);
        if (!report)
            return fail(report.status());
        std::printf("%.2f dB\n", report->psnr);
        if (report->psnr < 40)
            return 1;
    }
    const auto texels = read_box(path);
    if (!texels)
        return fail(texels.status());
    std::printf("%zu bytes\n", texels->size());
    return 0;
}
