#ifdef TESSERA_GPU
#include "tools/lab/bench/gpu_stage_times.h"

#include "tools/support/interrupt.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr int stages_in_flight = 64;

double& stage_of(BenchDecode& times, DecodeStage stage) {
    switch (stage) {
    case DecodeStage::upload:
        return times.upload;
    case DecodeStage::entropy:
        return times.entropy;
    case DecodeStage::order:
        return times.order;
    default:
        return times.transform;
    }
}

template <class Decode>
Status time_whole(unsigned repeats, const Decode& decode_all, double& milliseconds) {
    TESSERA_TRY_ASSIGN(auto log, IntervalLog::create(1, TimerClock::device));
    for (unsigned i = 0; i < repeats; ++i) {
        log.begin();
        TESSERA_TRY(decode_all());
        log.end();
    }
    milliseconds = 0;
    for (const double time : log.finish())
        milliseconds += time;
    return {};
}

} // namespace

Result<StageLog> StageLog::create(TimerClock clock) {
    TESSERA_TRY_ASSIGN(auto log, IntervalLog::create(stages_in_flight, clock));
    return StageLog(std::move(log));
}

StageHook StageLog::hook() {
    return [this](DecodeStage stage, bool begins) {
        if (!begins) {
            log_.end();
            return;
        }
        log_.begin();
        stages_.push_back(stage);
    };
}

void StageLog::take(BenchDecode& times) {
    const std::vector<double>& all = log_.finish();
    for (; taken_ < std::min(all.size(), stages_.size()); ++taken_) {
        stage_of(times, stages_[taken_]) += all[taken_];
        times.whole += all[taken_];
    }
}

Result<WholeDecode> time_whole_decode(const ContainerReader& reader, TimerClock clock,
                                      unsigned repeats) {
    TESSERA_TRY_ASSIGN(auto decoder, WholeFileDecoder::create(reader));
    WholeDecode whole;
    whole.times.tiles = reader.grid().tiles();
    whole.times.texels = texel_count(reader.desc().size);
    whole.blocks = decoder.blocks();
    whole.coefficients = decoder.coefficients();
    const auto decode_all = [&] { return decoder.decode([] { return interrupted_by() != 0; }); };
    TESSERA_TRY_ASSIGN(auto stages, StageLog::create(clock));
    decoder.set_stage_hook(stages.hook());
    for (unsigned i = 0; i < repeats; ++i)
        TESSERA_TRY(decode_all());
    stages.take(whole.times);
    decoder.set_stage_hook({});
    // The processor clock waits for the device at every stage anyway.
    if (clock == TimerClock::device)
        TESSERA_TRY(time_whole(repeats, decode_all, whole.times.whole));
    for (double* sum : {&whole.times.upload, &whole.times.entropy, &whole.times.order,
                        &whole.times.transform, &whole.times.whole})
        *sum /= repeats;
    return whole;
}

} // namespace tessera
#endif
