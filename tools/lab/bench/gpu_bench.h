// `tessera bench gpu`: the ways of having a texture on the device, drawn and timed side by side.
#pragma once

#include "codec/decoder.h"
#include "tools/lab/bench/gpu_bench_report.h"
#include "tools/view/render_views.h"

#include <optional>
#include <string>
#include <vector>

namespace tessera {

struct GpuBenchOptions {
    ViewRequest view; // orbit: frames of a turn; an empty size: one that suits the device
    std::optional<unsigned> frames, warm_up; // absent: as many as suit the device
    std::optional<unsigned> budget_mib;      // of the tile cache; absent: see bench_gpu()
    std::string original;                    // of the uncompressed texture; empty: none
    std::vector<std::string> skip;           // of "raw", "load", "feedback", "decode"
    ProgressFunction progress;
};

// Draws `options.frames` frames of the orbit in each way. Ways that the device, the file or the
// budget does not allow are rows that say so.
//
// Without a budget the tile cache gets a fifth of what the decoded texture takes; or, for small
// files, the least of about 1, 1.5, 2.25 and so on times that which makes a cache with a quarter more
// slots than the first view touches.
//
// Errors: bad_argument (a camera that cannot be; an original of another size), unsupported (no
// device, no sphere, a build without GPU), those of reading the files, runtime.
Result<BenchReport> bench_gpu(const std::string& file, const GpuBenchOptions& options);

} // namespace tessera
