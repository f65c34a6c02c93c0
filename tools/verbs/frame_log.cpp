#include "tools/verbs/frame_log.h"

#include "format/output_file.h"
#include "tools/support/parse.h"
#include "tools/view/view_file.h"

#include <cstdio>
#include <filesystem>

namespace tessera {
namespace {

std::string traffic_text(const Traffic& traffic, bool remote) {
    const char* unit = remote ? "request" : "read";
    return std::to_string(traffic.requests) + " " + unit + (traffic.requests == 1 ? "" : "s") +
           ", " + human_bytes(traffic.bytes);
}

void print_now(const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
}

} // namespace

std::string beside(const std::string& output, const std::string& what) {
    std::filesystem::path path = to_path(output);
    path.replace_filename(path.stem().string() + "-" + what + path.extension().string());
    return path.string();
}

void FrameLog::begin(std::size_t view, const std::string& output) {
    view_ = view;
    output_ = output;
    frames_.clear();
}

std::vector<DrawnFrame> FrameLog::end(const Traffic& traffic) {
    if (log_ && frames_.empty())
        print_now("view " + std::to_string(view_) + ": " + traffic_text(traffic, remote_));
    return std::move(frames_);
}

Status FrameLog::add(unsigned number, const DrawnFrame& frame,
                     const std::function<Result<View>()>& picture) {
    frames_.push_back(frame);
    if (log_) {
        const std::string view = "view " + std::to_string(view_);
        if (!frame.trouble.empty())
            print_now(view + ": retries: " + frame.trouble);
        print_now(view + " frame " + std::to_string(number) + ": " + std::to_string(frame.touched) +
                  " tiles touched, " + std::to_string(frame.decoded) + " decoded, " +
                  std::to_string(frame.coarse) + " coarse, " +
                  traffic_text(frame.traffic, remote_));
    }
    if (!write_)
        return {};
    TESSERA_TRY_ASSIGN(const View view, picture());
    return write_view(beside(output_, "frame-" + std::to_string(number)), view, type_);
}

} // namespace tessera
