// What the stages of decoding tiles on the device cost.
#pragma once

#include "decoder_glsl/gl_sampled_texture.h"
#include "format/container_reader.h"
#include "tools/lab/bench/gpu_bench_report.h"
#include "tools/lab/bench/gpu_times.h"

#include <vector>

namespace tessera {

// Times each stage of the decodes whose hook it is. Nothing else may be timed meanwhile.
class StageLog {
public:
    static Result<StageLog> create(TimerClock clock);
    // Valid as long as this object stays where it is.
    StageHook hook();
    // Waits for the device, and adds up all stages since the last call into `times`, whole as their
    // sum.
    void take(BenchDecode& times);

private:
    explicit StageLog(IntervalLog log) : log_(std::move(log)) {}

    IntervalLog log_;
    std::vector<DecodeStage> stages_;
    std::size_t taken_ = 0;
};

// The whole file, in batches as large as the decoder takes, into memory that is used again for each:
// what decoding on load does without reading the file. The mean of `repeats` after one to warm up.
// Errors: invalid_file, where a tile is damaged; io, runtime, unsupported.
struct WholeDecode {
    BenchDecode times;
    std::uint64_t blocks = 0, coefficients = 0;
};
Result<WholeDecode> time_whole_decode(const ContainerReader& reader, TimerClock clock,
                                      unsigned repeats);

} // namespace tessera
