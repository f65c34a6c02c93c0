// Measures every codec at every setting on one texture.
#pragma once

#include "tools/lab/rd/codec_under_test.h"
#include "tools/lab/rd/measurement.h"

#include <functional>
#include <string>
#include <vector>

namespace tessera {

struct SweepOptions {
    unsigned threads = 0;
    double timeout = 3600; // seconds, for each run of a tool
    // The range in dB that every curve should cover. A codec whose usual settings do not cover it
    // is also measured at coarser or finer ones. Once the first codec has a curve, that curve's range
    // replaces this one.
    double low_psnr = 36, high_psnr = 42;
    std::string cache;       // folder of measurements
    std::string keep_folder; // keeps the codecs' files; empty: they are deleted
    // Returns the progress function of measurement `number` (from 1) of `count`. It may be empty.
    std::function<ProgressFunction(std::size_t number, std::size_t count, const std::string& what)>
        progress;
    // Called after each measurement.
    std::function<void(const Measurement&, std::size_t number, std::size_t count)> done;
};

// Returns the measurements codec by codec, each codec's by ascending rate. If a codec fails, its
// measurement contains the reason. Errors: runtime, if the user interrupts; io, if the cache cannot
// be written.
Result<std::vector<Measurement>>
sweep(const RdTexture& texture, const std::vector<CodecUnderTest>& codecs, SweepOptions options);

} // namespace tessera
