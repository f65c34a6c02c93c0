// What all passes over a texture share, decided by passes over a sample: tables, filter, whether
// tiles have base pictures and whether copies are smoothed.
#pragma once

#include "codec/pass/sample_pass.h"
#include "format/tile/base_picture.h"
#include "format/tile/tile_filter.h"

#include <optional>

namespace tessera {

class FileChoices {
public:
    // Both outlive this.
    FileChoices(const EncodePlan& plan, const Sample& sample);

    // Parameters for a step (see steps.h) with everything that is decided so far.
    CodingParameters for_step(double step) const;

    // Runs passes over the sample with `parameters`, which come from for_step(). The first call
    // decides everything, so that passes at different steps are comparable; later calls only learn
    // the tables again. Returns the completed parameters. Errors: those of run_pass.
    Result<CodingParameters> prepare(CodingParameters parameters);

private:
    bool is_decided() const { return smooth_ && base_ && filter_; }

    const EncodePlan& plan_;
    const Sample& sample_;
    std::optional<bool> smooth_; // copies (FORMAT.md 4.6)
    std::optional<BasePictures> base_;
    std::optional<TileFilter> filter_;
    std::optional<Parameters> tables_;
};

} // namespace tessera
