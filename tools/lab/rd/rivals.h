// The codecs that Tessera is compared with. Each runs as its own command-line tools, with the
// texels in the layout that suits it best.
//
// Figures compare the real output of the decoder with the original and count all bytes. Times
// include starting the tools but not converting the texels for them.
#pragma once

#include "tools/lab/rd/codec_under_test.h"
#include "tools/lab/rd/subprocess.h"

#include <functional>
#include <string>
#include <vector>

namespace tessera {

struct Rival {
    std::string id, layout;
    std::vector<std::string> tools; // all are needed; empty: built in
    std::string package;            // the Debian package that provides the tools
    // Arguments that make the first tool print its version.
    std::vector<std::string> version_arguments;
    std::vector<std::string> settings, coarser, finer; // see CodecUnderTest
    bool in_plot = true;
    bool usual = true; // part of --rivals all
    bool quick = false;
    // Returns why the codec cannot take such a texture, or an empty string if it can.
    std::string (*not_applicable)(const TextureDesc& desc) = nullptr;
    std::function<Result<Coded>(const CodingJob&, const std::string& setting)> run;
};

// The families, in the order of the report.
std::vector<Rival> video_rivals();
std::vector<Rival> picture_rivals();
std::vector<Rival> array_rivals();
std::vector<Rival> all_rivals();

// The requested rivals, divided into those that can code a texture and those that cannot.
struct RivalChoice {
    std::vector<CodecUnderTest> present;
    struct Absent {
        std::string id, reason;
    };
    std::vector<Absent> absent; // not installed, or not applicable to the texture
};

// `list`: "all", "none", "quick", or ids separated by commas. Errors: bad_argument, for an unknown
// id.
Result<std::vector<Rival>> rivals_named(const std::string& list);
RivalChoice choose_rivals(const std::vector<Rival>& wanted, const TextureDesc& desc);

std::string value_of(const std::string& setting); // "crf 28" -> "28"
std::string threads_text(unsigned threads);       // 0: all cores
// Keeps the progress display alive while a tool runs that reports no progress. `job` must outlive
// the result.
TickFunction ticker(const CodingJob& job, const char* stage);
// Calls run_tool_well() and returns only the time.
Result<double> seconds_of_tool(const std::vector<std::string>& argv, double timeout,
                               const TickFunction& tick = {});
std::string needs_rgb8(const TextureDesc& desc);
Result<std::uint64_t> bytes_of_file(const std::string& path);
Result<std::vector<std::byte>> bytes_in_file(const std::string& path);

// Returns the best time of up to three runs. Runs shorter than half a second are repeated, because
// their times vary too much. `run` returns a Result<double> of seconds.
template <class Run> Result<double> best_time(const Run& run) {
    Result<double> best = run();
    for (int again = 0; again < 2 && best.ok() && *best < 0.5; ++again) {
        TESSERA_TRY_ASSIGN(const double seconds, run());
        *best = seconds < *best ? seconds : *best;
    }
    return best;
}

} // namespace tessera
