// The other codecs, each run through its own command-line tools in its best sensible layout.
//
// The figures are of the decoder's real output against the original, all bytes counted. Times are
// those of the tools alone: starting them counts, converting the texels for them does not.
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
    std::string package;            // of Debian, where the tools come from
    // Asks the first tool which version it is.
    std::vector<std::string> version_arguments;
    std::vector<std::string> settings, coarser, finer; // see CodecUnderTest
    bool in_plot = true;
    bool usual = true; // part of --rivals all
    bool quick = false;
    // Why this texture is nothing for it; empty: it is.
    std::string (*not_applicable)(const TextureDesc& desc) = nullptr;
    std::function<Result<Coded>(const CodingJob&, const std::string& setting)> run;
};

// By family, in the order of the report; video_rivals.cpp and so on.
std::vector<Rival> video_rivals();
std::vector<Rival> picture_rivals();
std::vector<Rival> array_rivals();
std::vector<Rival> all_rivals();

// What became of the rivals that were asked for, on one texture.
struct RivalChoice {
    std::vector<CodecUnderTest> present;
    struct Absent {
        std::string id, reason;
    };
    std::vector<Absent> absent; // not installed, or nothing for this texture
};

// `list`: "all", "none", "quick", or ids with commas. Errors: bad_argument, for an unknown id.
Result<std::vector<Rival>> rivals_named(const std::string& list);
RivalChoice choose_rivals(const std::vector<Rival>& wanted, const TextureDesc& desc);

// Shared by the families.
std::string value_of(const std::string& setting); // "crf 28" -> "28"
std::string threads_text(unsigned threads);       // 0: all cores
// Shows that a tool is at work which does not say how far it is. `job` outlives it.
TickFunction ticker(const CodingJob& job, const char* stage);
// run_tool_well(), and only the time it took.
Result<double> seconds_of_tool(const std::vector<std::string>& argv, double timeout,
                               const TickFunction& tick = {});
std::string needs_rgb8(const TextureDesc& desc);
Result<std::uint64_t> bytes_of_file(const std::string& path);
Result<std::vector<std::byte>> bytes_in_file(const std::string& path);

// Runs what is short several times and takes the best: tools that finish within a blink are
// measured by chance otherwise. `run` returns a Result<double> of seconds.
template <class Run> Result<double> best_time(const Run& run) {
    Result<double> best = run();
    for (int again = 0; again < 2 && best.ok() && *best < 0.5; ++again) {
        TESSERA_TRY_ASSIGN(const double seconds, run());
        *best = seconds < *best ? seconds : *best;
    }
    return best;
}

} // namespace tessera
