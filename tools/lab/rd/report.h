// The results of `tessera rd` as text, CSV, JSON and one HTML page with plots.
#pragma once

#include "tools/lab/rd/bd_rate.h"
#include "tools/lab/rd/measurement.h"
#include "tools/lab/rd/rivals.h"
#include "tools/support/json_text.h"

#include <string>
#include <utility>
#include <vector>

namespace tessera {

struct CodecInfo {
    std::string id, layout, version;
    bool in_plot = true;
};

struct TextureReport {
    std::string name, size, type, crop, checksum;
    unsigned channels = 3;
    std::uint64_t raw_bytes = 0;
    double background_share = 0;
    bool rendered = false;
    std::vector<CodecInfo> codecs;
    std::vector<Measurement> rows;
    std::vector<RivalChoice::Absent> absent;
    std::string anchor; // a codec's id

    bool hdr() const { return type != "unorm8"; }
    const CodecInfo* codec(const std::string& id) const;
};

struct RdReport {
    std::string command; // as typed
    std::string machine; // processor and threads
    std::vector<TextureReport> textures;
};

// BD-rates of a codec against the anchor, one per measure. Absent if either codec lacks the measure
// or their curves do not overlap.
struct BdRow {
    std::string codec;
    std::optional<BdRate> rgb, yuv, worst_view, foreground, rendered, pu21, log2;
};
std::vector<BdRow> bd_rows(const TextureReport& texture);

// A table of titles and cells, from which both the text and the page are written.
struct RdTable {
    std::vector<std::string> titles;
    std::vector<std::vector<std::string>> rows;
    std::size_t names = 1; // number of leading columns that hold words
};
RdTable measurement_table(const TextureReport& texture);
RdTable bd_table(const TextureReport& texture);
// One row per codec and effort, at the setting whose PSNR is nearest to `speed_psnr`.
RdTable speed_table(const TextureReport& texture);
constexpr double speed_psnr = 39;

// Explanations of the figures, one paragraph per group of columns.
std::vector<std::string> definitions(const RdReport& report);

std::string to_text(const RdReport& report);
std::string to_csv(const RdReport& report);
Json to_json(const RdReport& report);
std::string to_page(const RdReport& report); // one HTML file that includes the plots

} // namespace tessera
