// Every codec at every setting, on one texture.
#pragma once

#include "tools/lab/rd/codec_under_test.h"
#include "tools/lab/rd/measurement.h"

#include <functional>
#include <string>
#include <vector>

namespace tessera {

struct SweepOptions {
    unsigned threads = 0;
    double timeout = 3600; // seconds, of each run of a tool
    // dB that every curve should reach below and above: a codec whose usual settings do not is
    // measured at coarser or finer ones. Once the first codec has a curve its range takes their place.
    double low_psnr = 36, high_psnr = 42;
    std::string cache;       // folder of measurements
    std::string keep_folder; // where files of the codecs stay; empty: nowhere
    // The progress of measurement `number` (from 1) of `count`; may give an empty function.
    std::function<ProgressFunction(std::size_t number, std::size_t count, const std::string& what)>
        progress;
    // Called after each.
    std::function<void(const Measurement&, std::size_t number, std::size_t count)> done;
};

// Measurements in the order of the codecs, each from few bits to many. A codec that fails is a
// measurement that says so. Errors: runtime, when interrupted; io, where the cache cannot be written.
Result<std::vector<Measurement>>
sweep(const RdTexture& texture, const std::vector<CodecUnderTest>& codecs, SweepOptions options);

} // namespace tessera
