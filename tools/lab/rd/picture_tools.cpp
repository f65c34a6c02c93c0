#include "tools/lab/rd/picture_tools.h"

#include "tools/lab/rd/rivals.h" // value_of

namespace tessera {
namespace {

using Argv = std::vector<std::string>;

Argv encode_avif(const std::string& in, const std::string& out, const std::string& setting,
                 const std::string& threads) {
    const std::string q = value_of(setting);
    return {"avifenc", "--speed",   "0",           "--yuv", "444",
            "--depth", "10",        "--min",       "0",     "--max",
            "63",      "-a",        "end-usage=q", "-a",    "cq-level=" + q,
            "-a",      "tune=psnr", "--jobs",      threads, in,
            out};
}
Argv encode_avif_planes(const std::string& in, const std::string& out, const std::string& setting,
                        const std::string& threads) {
    Argv argv = encode_avif(in, out, setting, threads);
    argv.insert(argv.begin() + 1, {"--cicp", "1/13/0"}); // the identity matrix
    return argv;
}
Argv decode_avif(const std::string& in, const std::string& out, const std::string& threads) {
    return {"avifdec", "--depth", "8", "--jobs", threads, in, out};
}

Argv encode_jxl(const std::string& in, const std::string& out, const std::string& setting,
                const std::string& threads) {
    return {"cjxl",
            in,
            out,
            "--quiet",
            "--effort=9",
            "--distance=" + value_of(setting),
            "--num_threads=" + threads};
}
Argv decode_jxl(const std::string& in, const std::string& out, const std::string& threads) {
    return {"djxl", in, out, "--quiet", "--num_threads=" + threads};
}

Argv encode_astc(const std::string& in, const std::string& out, const std::string& setting,
                 const std::string& threads) {
    return {"astcenc", "-cl", in, out, value_of(setting), "-medium", "-silent", "-j", threads};
}
Argv decode_astc(const std::string& in, const std::string& out, const std::string& threads) {
    return {"astcenc", "-dl", in, out, "-silent", "-j", threads};
}

const PictureTool tool_of_avif = {"avif",
                                  "libaom at speed 0, tune psnr, 10 bits, 4:4:4",
                                  {"avifenc", "avifdec"},
                                  "libavif-bin",
                                  {"--version"},
                                  16384,
                                  "avif",
                                  "png",
                                  {"q 45", "q 36", "q 28", "q 20"},
                                  {"q 54"},
                                  {"q 14", "q 8"},
                                  encode_avif,
                                  decode_avif};

const PictureTool tool_of_avif_planes = [] {
    PictureTool tool = tool_of_avif;
    tool.id = "avif:planes";
    tool.about = "libaom at speed 0, tune psnr, 10 bits, channels as planes (no colour transform)";
    tool.encode = encode_avif_planes;
    return tool;
}();

const PictureTool tool_of_jxl = {"jxl",
                                 "effort 9",
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
                                 decode_jxl};

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

const PictureTool& avif_tool() {
    return tool_of_avif;
}

const PictureTool& avif_planes_tool() {
    return tool_of_avif_planes;
}

const PictureTool& jxl_tool() {
    return tool_of_jxl;
}

const PictureTool& astc_tool() {
    return tool_of_astc;
}

} // namespace tessera
