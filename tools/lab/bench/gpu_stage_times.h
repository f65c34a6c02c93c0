// Times the stages of decoding tiles on the GPU.
#pragma once

#include "decoder_glsl/gl_sampled_texture.h"
#include "format/container_reader.h"
#include "tools/lab/bench/gpu_bench_report.h"
#include "tools/lab/bench/gpu_times.h"

#include <vector>

namespace tessera {

// Times each stage of the decodes that call its hook. No other timer of the context may run at the
// same time.
class StageLog {
public:
    static Result<StageLog> create(TimerClock clock);
    // The hook is valid until this object is moved or destroyed.
    StageHook hook();
    // Waits for the device and adds the times of all stages since the last call to `times`. Adds
    // their sum to `times.whole`.
    void take(BenchDecode& times);

private:
    explicit StageLog(IntervalLog log) : log_(std::move(log)) {}

    IntervalLog log_;
    std::vector<DecodeStage> stages_;
    std::size_t taken_ = 0;
};

// Decodes the whole file `repeats` times, in the largest batches that the decoder takes, each batch
// into the same memory. This is what decoding on load does, without reading the file. Returns mean
// times. Errors: invalid_file, if a tile is damaged; io; runtime; unsupported.
struct WholeDecode {
    BenchDecode times;
    std::uint64_t blocks = 0, coefficients = 0;
};
Result<WholeDecode> time_whole_decode(const ContainerReader& reader, TimerClock clock,
                                      unsigned repeats);

} // namespace tessera
