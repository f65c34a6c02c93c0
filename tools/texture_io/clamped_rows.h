// Counts samples of pictures that are beyond the range of half floats. Rows that are read again, in
// later passes or for other slabs, are not counted again.
#pragma once

#include "tools/support/warnings.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

class ClampedRows {
public:
    // `counted`: by row, whether it was counted before; one picture's.
    explicit ClampedRows(std::vector<bool>& counted) : counted_(counted) {}

    void add(std::uint32_t row, std::uint64_t samples) {
        if (samples == 0)
            return;
        if (counted_.size() <= row)
            counted_.resize(row + 1);
        if (!counted_[row])
            samples_ += samples;
        counted_[row] = true;
    }

    // Errors: unsupported, if warnings are errors.
    Status say(Warnings* warnings, const std::string& place) const {
        if (warnings == nullptr)
            return {};
        return warnings->add("samples beyond +-65504, the range of half floats, became +-65504",
                             place, samples_);
    }

private:
    std::vector<bool>& counted_;
    std::uint64_t samples_ = 0;
};

} // namespace tessera
