// Video codecs: the views in serpentine order are the frames.
#include "tools/lab/rd/rivals.h"
#include "tools/lab/rd/view_layout.h"
#include "tools/support/output_folders.h"

#include <algorithm>
#include <fstream>

namespace tessera {
namespace {

constexpr const char* chroma_filter = "lanczos+accurate_rnd+full_chroma_inp";

struct VideoInput {
    std::string path, width, height, frames, threads;
};

struct VideoTool {
    bool in_y4m = false;
    VideoSamples samples = VideoSamples::bits8;
    unsigned group = 0; // frames between key frames; 0: only the first frame is a key frame
    const char* ending = "";
    std::vector<std::string> (*encode)(const VideoInput& in, const std::string& out,
                                       const std::string& setting, unsigned group) = nullptr;
};

// Tuned for PSNR, by which it is compared: the default tuning costs 1.5 dB at equal bits.
std::vector<std::string> x265(const char* preset, const VideoInput& in, const std::string& out,
                              const std::string& setting, unsigned group) {
    std::vector<std::string> argv = {
        "x265",    "--input",  in.path,     "--input-res",   in.width + "x" + in.height,
        "--fps",   "30",       "--tune",    "psnr",          "--input-csp",
        "i444",    "--preset", preset,      "--crf",         value_of(setting),
        "--pools", in.threads, "--no-info", "--no-progress", "--log-level",
        "error",   "--output", out};
    const std::string keyint = group > 0 ? std::to_string(group) : "-1";
    argv.insert(argv.end(), {"--keyint", keyint});
    if (group > 0) // makes every group decodable alone
        argv.insert(argv.end(), {"--min-keyint", keyint, "--no-open-gop", "--no-scenecut"});
    return argv;
}

std::vector<std::string> x265_slower(const VideoInput& in, const std::string& out,
                                     const std::string& setting, unsigned group) {
    return x265("slower", in, out, setting, group);
}

std::vector<std::string> x265_medium(const VideoInput& in, const std::string& out,
                                     const std::string& setting, unsigned group) {
    return x265("medium", in, out, setting, group);
}

// Ten bits hold YCgCo exactly. One pass, 8 bits or speed 4 would need more bits at equal PSNR.
std::vector<std::string> libaom(const VideoInput& in, const std::string& out,
                                const std::string& setting, unsigned) {
    return {"aomenc",
            in.path,
            "--obu",
            "-o",
            out,
            "--profile=1",
            "--i444",
            "--end-usage=q",
            "--cq-level=" + value_of(setting),
            "--cpu-used=2",
            "--passes=2",
            "--bit-depth=10",
            "--tune=psnr",
            "--lag-in-frames=35",
            "--kf-max-dist=9999",
            "--threads=" + in.threads,
            "--quiet"};
}

// SVT-AV1 supports only 4:2:0. Ten bits keep the other losses small. ffmpeg halves the resolution
// of Cg and Co, and decoder() doubles it again.
std::vector<std::string> svt_av1(const VideoInput& in, const std::string& out,
                                 const std::string& setting, unsigned) {
    return {"ffmpeg",
            "-nostdin",
            "-v",
            "error",
            "-y",
            "-f",
            "rawvideo",
            "-pix_fmt",
            "yuv444p",
            "-s",
            in.width + "x" + in.height,
            "-r",
            "30",
            "-i",
            in.path,
            "-sws_flags",
            chroma_filter,
            "-pix_fmt",
            "yuv420p10le",
            "-c:v",
            "libsvtav1",
            "-preset",
            "4",
            "-crf",
            value_of(setting),
            "-g",
            "9999",
            "-svtav1-params",
            "lp=" + in.threads,
            out};
}

// YUV4MPEG2 has one header line for the video and one before each frame.
Status write_y4m(const std::string& path, std::span<const std::byte> video, VideoSamples samples,
                 const VideoInput& in, std::size_t frame_bytes) {
    std::ofstream file(path, std::ios::binary);
    file << "YUV4MPEG2 W" << in.width << " H" << in.height << " F30:1 Ip A1:1 C444"
         << (samples == VideoSamples::bits10 ? "p10" : "") << "\n";
    for (std::size_t at = 0; at < video.size(); at += frame_bytes) {
        file << "FRAME\n";
        file.write(reinterpret_cast<const char*>(video.data() + at),
                   static_cast<std::streamsize>(frame_bytes));
    }
    file.close();
    return file ? Status() : Status(ErrorCode::io, path + ": cannot be written");
}

// ffmpeg decodes the streams of all encoders, to the plane layout of the encoder's input.
std::vector<std::string> decoder(const std::string& in, const std::string& out,
                                 const VideoInput& input, VideoSamples samples) {
    const char* planes = samples == VideoSamples::bits10 ? "yuv444p10le" : "yuv444p";
    return {"ffmpeg", "-nostdin",   "-v",          "error", "-threads", input.threads, "-y",   "-i",
            in,       "-sws_flags", chroma_filter, "-f",    "rawvideo", "-pix_fmt",    planes, out};
}

// A reader starts at a key frame and decodes up to the wanted frame, on average half of a group.
double access_bytes(std::uint64_t bytes, std::size_t frames, unsigned group) {
    const double length = group > 0 ? std::min<double>(group, static_cast<double>(frames))
                                    : static_cast<double>(frames);
    return static_cast<double>(bytes) / static_cast<double>(frames) * (length + 1) / 2;
}

Result<Coded> code_video(const VideoTool& tool, const CodingJob& job, const std::string& setting) {
    const Extent4& n = job.texture.desc.size;
    const std::size_t frames = std::size_t{n[axis_s]} * n[axis_t];
    const VideoInput input{job.folder.at(tool.in_y4m ? "in.y4m" : "in.yuv"),
                           std::to_string(n[axis_u]), std::to_string(n[axis_v]),
                           std::to_string(frames), threads_text(job.threads)};
    const std::string stream = job.folder.at(std::string("video.") + tool.ending);
    const std::string output = job.folder.at("out.yuv");
    const auto video = video_of(job.texture, tool.samples);
    TESSERA_TRY(tool.in_y4m
                    ? write_y4m(input.path, video, tool.samples, input, video.size() / frames)
                    : write_bytes(input.path, video));
    Coded coded;
    TESSERA_TRY_ASSIGN(coded.encode_seconds,
                       seconds_of_tool(tool.encode(input, stream, setting, tool.group), job.timeout,
                                       ticker(job, "encoding")));
    TESSERA_TRY_ASSIGN(coded.bytes, bytes_of_file(stream));
    TESSERA_TRY_ASSIGN(coded.decode_seconds, best_time([&] {
                           return seconds_of_tool(decoder(stream, output, input, tool.samples),
                                                  job.timeout, ticker(job, "decoding"));
                       }));
    TESSERA_TRY_ASSIGN(const auto back, bytes_in_file(output));
    if (back.size() != video.size())
        return Status(ErrorCode::runtime, "decoded " + std::to_string(back.size()) +
                                              " bytes of video instead of " +
                                              std::to_string(video.size()));
    coded.texels.resize(job.texture.texels.size());
    store_video(back, tool.samples, n, coded.texels);
    coded.texel_bytes = coded.view_bytes = access_bytes(coded.bytes, frames, tool.group);
    return coded;
}

struct Ladder {
    std::vector<std::string> usual, coarser, finer;
};

Rival video_rival(const char* id, const char* layout, std::vector<std::string> tools,
                  const char* package, std::vector<std::string> version, const Ladder& ladder,
                  const VideoTool& tool) {
    Rival rival;
    rival.id = id;
    rival.layout = layout;
    rival.tools = std::move(tools);
    rival.tools.push_back("ffmpeg");
    rival.package = package;
    rival.version_arguments = std::move(version);
    rival.settings = ladder.usual;
    rival.coarser = ladder.coarser;
    rival.finer = ladder.finer;
    rival.not_applicable = needs_rgb8;
    rival.run = [tool](const CodingJob& job, const std::string& setting) {
        return code_video(tool, job, setting);
    };
    return rival;
}

} // namespace

std::vector<Rival> video_rivals() {
    const Ladder crf{{"crf 34", "crf 29", "crf 24", "crf 19"},
                     {"crf 39", "crf 44"},
                     {"crf 14", "crf 9", "crf 4"}};
    const Ladder cq{{"cq 54", "cq 44", "cq 32", "cq 20"}, {"cq 60"}, {"cq 12", "cq 8", "cq 5"}};
    const Ladder av1{{"crf 50", "crf 40", "crf 30", "crf 20"}, {"crf 58"}, {"crf 12", "crf 5"}};
    std::vector<Rival> all;
    const auto add = [&all](Rival rival) { all.push_back(std::move(rival)); };
    add(video_rival("x265", "preset slower, tune psnr, YCgCo 4:4:4, one sequence of views",
                    {"x265"}, "x265 and ffmpeg", {"--version"}, crf,
                    {false, VideoSamples::bits8, 0, "hevc", x265_slower}));
    add(video_rival("x265:8", "preset slower, tune psnr, YCgCo 4:4:4, groups of 8 views", {"x265"},
                    "x265 and ffmpeg", {"--version"}, crf,
                    {false, VideoSamples::bits8, 8, "hevc", x265_slower}));
    add(video_rival("x265:medium", "preset medium, tune psnr, YCgCo 4:4:4, one sequence of views",
                    {"x265"}, "x265 and ffmpeg", {"--version"}, crf,
                    {false, VideoSamples::bits8, 0, "hevc", x265_medium}));
    all.back().usual = false;
    all.back().quick = true;
    add(video_rival(
        "aom",
        "libaom at speed 2, two passes, tune psnr, 10-bit YCgCo 4:4:4, one sequence of views",
        {"aomenc"}, "aom-tools and ffmpeg", {"--help"}, cq,
        {true, VideoSamples::bits10, 0, "obu", libaom}));
    add(video_rival(
        "svtav1", "preset 4, 10-bit YCgCo 4:2:0 (it supports no other), one sequence of views", {},
        "ffmpeg", {"-version"}, av1, {false, VideoSamples::bits8, 0, "obu", svt_av1}));
    return all;
}

} // namespace tessera
