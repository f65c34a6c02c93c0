// `tessera bench gpu`: draws and times a texture in each way that it can be held on the GPU.
#pragma once

#include "codec/decoder.h"
#include "tools/lab/bench/gpu_bench_report.h"
#include "tools/view/render_views.h"

#include <optional>
#include <string>
#include <vector>

namespace tessera {

struct GpuBenchOptions {
    ViewRequest view; // orbit: frames per turn; an empty size: one that suits the device
    std::optional<unsigned> frames, warm_up; // absent: as many as suit the device
    std::optional<unsigned> budget_mib;      // for the tile cache; absent: see bench_gpu()
    std::string original;                    // path of the uncompressed texture, or empty
    std::vector<std::string> skip;           // any of "raw", "load", "feedback", "decode"
    ProgressFunction progress;
};

// Draws `options.frames` frames of the orbit in each way. If the device, the file or the budget
// does not allow a way, its row contains the reason.
//
// Without a budget the tile cache gets a fifth of the size of the decoded texture. This grows in
// steps of a half until the cache has a quarter more slots than the first view touches.
//
// Errors: bad_argument (an impossible camera, an original of a different size), unsupported (no
// device, no sphere or mesh, a build without GPU), those of reading the files, runtime.
Result<BenchReport> bench_gpu(const std::string& file, const GpuBenchOptions& options);

} // namespace tessera
