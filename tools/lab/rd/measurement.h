// One codec at one setting on one texture, and how it is kept between runs.
#pragma once

#include "tools/lab/rd/quality.h"
#include "tools/support/json_text.h"

#include <optional>
#include <string>

namespace tessera {

struct Measurement {
    std::string codec, setting; // "x265:8", "crf 25"
    std::string failed;         // why there are no figures; empty: there are
    std::uint64_t bytes = 0;
    double bits_per_texel = 0;
    Quality quality;
    double encode_mbs = 0, decode_mbs = 0; // MB of raw texture per second; 0: nothing is done
    std::optional<double> texel_bytes, view_bytes; // touched to read one texel, one view
    std::string note;
    bool cached = false; // from an earlier run
};

Json to_json(const Measurement& measurement);
// Nothing where `json` is not what to_json() makes.
std::optional<Measurement> measurement_from_json(const Json& json);

// Measurements of earlier runs, one file each, so that an interrupted sweep goes on where it
// stopped. Failures are not kept: what failed is tried again.
class MeasurementCache {
public:
    // `folder` is created when something is kept first.
    explicit MeasurementCache(std::string folder) : folder_(std::move(folder)) {}

    // `key` says everything that the figures depend on. Damaged files count as absent.
    std::optional<Measurement> find(const Json& key) const;
    // Appears under its name when it is whole. Errors: io.
    Status keep(const Json& key, const Measurement& measurement) const;

private:
    std::string path_of(const Json& key) const;
    std::string folder_;
};

} // namespace tessera
