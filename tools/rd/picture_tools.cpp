#include "tools/rd/picture_tools.h"

#include "tools/rd/rivals.h" // value_of

#include <algorithm>

namespace tessera {
namespace {

using Argv = std::vector<std::string>;

Argv encode_avif(const std::string& in, const std::string& out, const std::string& setting,
                 const Picture&, const std::string& threads) {
    const std::string q = value_of(setting);
    return {"avifenc", "--speed", "4",      "--yuv", "444", "--min", q,
            "--max",   q,         "--jobs", threads, in,    out};
}
Argv decode_avif(const std::string& in, const std::string& out, const std::string& threads) {
    return {"avifdec", "--jobs", threads, in, out};
}

Argv encode_jxl(const std::string& in, const std::string& out, const std::string& setting,
                const Picture&, const std::string& threads) {
    return {"cjxl",
            in,
            out,
            "--quiet",
            "--effort=7",
            "--distance=" + value_of(setting),
            "--num_threads=" + threads};
}
Argv decode_jxl(const std::string& in, const std::string& out, const std::string& threads) {
    return {"djxl", in, out, "--quiet", "--num_threads=" + threads};
}

// Without the spatial shaping that serves the eye: PSNR is what is measured.
Argv encode_webp(const std::string& in, const std::string& out, const std::string& setting,
                 const Picture&, const std::string&) {
    return {"cwebp", "-quiet",          "-mt", "-m", "6", "-sns", "0", "-sharp_yuv",
            "-q",    value_of(setting), in,    "-o", out};
}
Argv decode_webp(const std::string& in, const std::string& out, const std::string&) {
    return {"dwebp", "-quiet", "-mt", "-ppm", in, "-o", out};
}

// As many resolutions as the picture has, up to the usual six.
Argv encode_jp2(const std::string& in, const std::string& out, const std::string& setting,
                const Picture& picture, const std::string& threads) {
    unsigned resolutions = 1;
    while (resolutions < 6 && std::min(picture.width, picture.height) >> resolutions > 0)
        ++resolutions;
    return {"opj_compress",
            "-i",
            in,
            "-o",
            out,
            "-I",
            "-q",
            value_of(setting),
            "-n",
            std::to_string(resolutions),
            "-threads",
            threads};
}
Argv decode_jp2(const std::string& in, const std::string& out, const std::string& threads) {
    return {"opj_decompress", "-i", in, "-o", out, "-threads", threads};
}

Argv encode_astc(const std::string& in, const std::string& out, const std::string& setting,
                 const Picture&, const std::string& threads) {
    return {"astcenc", "-cl", in, out, value_of(setting), "-medium", "-silent", "-j", threads};
}
Argv decode_astc(const std::string& in, const std::string& out, const std::string& threads) {
    return {"astcenc", "-dl", in, out, "-silent", "-j", threads};
}

const PictureTool tools_of_pictures[] = {
    {"avif",
     "libaom at speed 4, 4:4:4",
     {"avifenc", "avifdec"},
     "libavif-bin",
     {"--version"},
     16384,
     "avif",
     "png",
     {"q 54", "q 42", "q 30", "q 20"},
     {"q 60"},
     {"q 12", "q 6"},
     encode_avif,
     decode_avif},
    {"jxl",
     "effort 7",
     {"cjxl", "djxl"},
     "libjxl-tools",
     {"--version"},
     65535,
     "jxl",
     "ppm",
     {"distance 6", "distance 3", "distance 1.5", "distance 0.8"},
     {"distance 10", "distance 15"},
     {"distance 0.4", "distance 0.2", "distance 0.1"},
     encode_jxl,
     decode_jxl},
    {"webp",
     "method 6, sharp 4:2:0 (it knows no other)",
     {"cwebp", "dwebp"},
     "webp",
     {"-version"},
     16383,
     "webp",
     "ppm",
     {"q 20", "q 50", "q 75", "q 92"},
     {"q 5"},
     {"q 97", "q 100"},
     encode_webp,
     decode_webp},
    {"jp2",
     "9/7 wavelet",
     {"opj_compress", "opj_decompress"},
     "libopenjp2-tools",
     {"-h"},
     65535,
     "jp2",
     "ppm",
     {"dB 35", "dB 38", "dB 41", "dB 44"},
     {"dB 32", "dB 29", "dB 26"},
     {},
     encode_jp2,
     decode_jp2}};

const PictureTool tool_of_astc = {"astc",
                                  "2D blocks of the mosaic of views, -medium",
                                  {"astcenc"},
                                  "astcenc",
                                  {"-version"},
                                  16384,
                                  "astc",
                                  "png",
                                  {"block 12x12", "block 8x8", "block 6x6", "block 4x4"},
                                  {},
                                  {},
                                  encode_astc,
                                  decode_astc};

} // namespace

std::span<const PictureTool> picture_tools() {
    return tools_of_pictures;
}

const PictureTool& astc_tool() {
    return tool_of_astc;
}

} // namespace tessera
