// The measurement of one codec at one setting on one texture, and its cache on disk.
#pragma once

#include "tools/lab/rd/quality.h"
#include "tools/support/json_text.h"

#include <optional>
#include <string>

namespace tessera {

struct Measurement {
    std::string codec, setting; // "x265:8", "crf 25"
    std::string failed;         // why there are no figures; empty on success
    std::uint64_t bytes = 0;
    double bits_per_texel = 0;
    Quality quality;
    double encode_mbs = 0, decode_mbs = 0; // MB of raw texture per second; 0: no work to time
    std::optional<double> texel_bytes, view_bytes; // bytes read for one texel or one view
    std::string note;
    bool cached = false; // measured by an earlier run
};

Json to_json(const Measurement& measurement);
// Returns nothing if `json` does not have the form that to_json() writes.
std::optional<Measurement> measurement_from_json(const Json& json);

// Measurements of earlier runs, one file each, so that an interrupted sweep continues where it
// stopped. The sweep does not store failures: it tries them again.
class MeasurementCache {
public:
    // The first keep() creates `folder`.
    explicit MeasurementCache(std::string folder) : folder_(std::move(folder)) {}

    // `key` contains everything that the figures depend on. Damaged files count as absent.
    std::optional<Measurement> find(const Json& key) const;
    // Writes the file atomically. Errors: io.
    Status keep(const Json& key, const Measurement& measurement) const;

private:
    std::string path_of(const Json& key) const;
    std::string folder_;
};

} // namespace tessera
