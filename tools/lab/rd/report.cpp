#include "tools/lab/rd/report.h"

#include "tools/support/parse.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

std::string db_text(const std::optional<double>& db) {
    if (!db)
        return "-";
    return std::isfinite(*db) ? format_number(*db, 2) : "exact";
}

std::string bits_text(double bits) {
    return format_number(bits, bits < 0.1 ? 5 : bits < 1 ? 4 : 3);
}

std::string speed_text(double mbs) {
    return mbs <= 0 ? "-" : format_number(mbs, mbs < 10 ? 2 : mbs < 100 ? 1 : 0);
}

std::string bytes_text(const std::optional<double>& bytes) {
    return bytes ? human_bytes(static_cast<std::uint64_t>(std::llround(*bytes))) : "-";
}

std::string bd_text(const std::optional<BdRate>& rate) {
    if (!rate)
        return "-";
    return (rate->percent >= 0 ? "+" : "") + format_number(rate->percent, 1) + " %";
}

struct Measure {
    const char* title;
    std::optional<double> (*of)(const Quality&);
    std::optional<BdRate> BdRow::*rate;
};
const Measure measures[] = {
    {"RGB", [](const Quality& q) { return std::optional(q.psnr_rgb); }, &BdRow::rgb},
    {"YUV 6:1:1", [](const Quality& q) { return q.psnr_yuv; }, &BdRow::yuv},
    {"worst view", [](const Quality& q) { return std::optional(q.psnr_worst_view); },
     &BdRow::worst_view},
    {"foreground", [](const Quality& q) { return q.psnr_foreground; }, &BdRow::foreground},
    {"rendered", [](const Quality& q) { return q.psnr_rendered; }, &BdRow::rendered},
    {"PU21", [](const Quality& q) { return q.psnr_pu21; }, &BdRow::pu21},
    {"log2", [](const Quality& q) { return q.psnr_log2; }, &BdRow::log2}};

// Returns whether any row of the texture has the measure.
bool occurs(const TextureReport& texture, const Measure& measure) {
    return std::any_of(texture.rows.begin(), texture.rows.end(), [&](const Measurement& m) {
        return m.failed.empty() && measure.of(m.quality).has_value();
    });
}

std::vector<RatePoint> curve(const TextureReport& texture, const std::string& codec,
                             const Measure& measure) {
    std::vector<RatePoint> points;
    for (const Measurement& m : texture.rows)
        if (m.codec == codec && m.failed.empty())
            if (const auto psnr = measure.of(m.quality))
                points.push_back({m.bits_per_texel, *psnr});
    return points;
}

} // namespace

const CodecInfo* TextureReport::codec(const std::string& id) const {
    for (const CodecInfo& info : codecs)
        if (info.id == id)
            return &info;
    return nullptr;
}

std::vector<BdRow> bd_rows(const TextureReport& texture) {
    std::vector<BdRow> rows;
    for (const CodecInfo& info : texture.codecs) {
        BdRow row;
        row.codec = info.id;
        for (const Measure& measure : measures)
            row.*measure.rate =
                bd_rate(curve(texture, texture.anchor, measure), curve(texture, info.id, measure));
        rows.push_back(std::move(row));
    }
    return rows;
}

RdTable measurement_table(const TextureReport& texture) {
    RdTable table;
    table.names = 2;
    table.titles = {"codec", "setting", "bytes", "bpt"};
    for (const Measure& measure : measures)
        if (occurs(texture, measure))
            table.titles.push_back(measure.title);
    for (const char* title :
         {"max error", "enc MB/s", "dec MB/s", "for a texel", "for a view", "note"})
        table.titles.push_back(title);
    for (const Measurement& m : texture.rows) {
        std::vector<std::string> cells = {m.codec, m.setting};
        if (m.failed.empty()) {
            cells.push_back(std::to_string(m.bytes));
            cells.push_back(bits_text(m.bits_per_texel));
            for (const Measure& measure : measures)
                if (occurs(texture, measure))
                    cells.push_back(db_text(measure.of(m.quality)));
            cells.push_back(std::to_string(m.quality.max_error));
            cells.push_back(speed_text(m.encode_mbs));
            cells.push_back(speed_text(m.decode_mbs));
            cells.push_back(bytes_text(m.texel_bytes));
            cells.push_back(bytes_text(m.view_bytes));
            cells.push_back(m.note);
        } else {
            cells.resize(table.titles.size() - 1, "-");
            cells.push_back("failed: " + m.failed);
        }
        table.rows.push_back(std::move(cells));
    }
    return table;
}

RdTable bd_table(const TextureReport& texture) {
    RdTable table;
    table.titles = {"codec"};
    for (const Measure& measure : measures)
        if (occurs(texture, measure))
            table.titles.push_back(measure.title);
    table.titles.push_back("over dB (RGB)");
    for (const BdRow& row : bd_rows(texture)) {
        std::vector<std::string> cells = {row.codec};
        for (const Measure& measure : measures)
            if (occurs(texture, measure))
                cells.push_back(row.codec == texture.anchor ? "anchor"
                                                            : bd_text(row.*measure.rate));
        cells.push_back(row.rgb ? format_number(row.rgb->low, 1) + " to " +
                                      format_number(row.rgb->high, 1)
                                : "-");
        table.rows.push_back(std::move(cells));
    }
    return table;
}

RdTable speed_table(const TextureReport& texture) {
    RdTable table;
    table.names = 2;
    table.titles = {"codec",     "setting", "enc MB/s",    "dec MB/s",  "PSNR",
                    "max error", "bpt",     "for a texel", "for a view"};
    for (const CodecInfo& info : texture.codecs) {
        const Measurement* nearest = nullptr;
        // Clamped, because a lossless row must still be chosen if it is the only one.
        const auto distance = [](const Measurement& m) {
            return std::min(std::abs(m.quality.psnr_rgb - speed_psnr), 1e6);
        };
        for (const Measurement& m : texture.rows)
            if (m.codec == info.id && m.failed.empty() &&
                (!nearest || distance(m) < distance(*nearest)))
                nearest = &m;
        if (nearest)
            table.rows.push_back(
                {info.id, nearest->setting, speed_text(nearest->encode_mbs),
                 speed_text(nearest->decode_mbs), db_text(nearest->quality.psnr_rgb),
                 std::to_string(nearest->quality.max_error), bits_text(nearest->bits_per_texel),
                 bytes_text(nearest->texel_bytes), bytes_text(nearest->view_bytes)});
    }
    return table;
}

std::vector<std::string> definitions(const RdReport& report) {
    const bool hdr = std::any_of(report.textures.begin(), report.textures.end(),
                                 [](const TextureReport& t) { return t.hdr(); });
    std::vector<std::string> lines = {
        "bpt: bits per texel, for all channels together, from all bytes that a decoder needs.",
        "RGB: PSNR over all samples of the colour channels, in dB, from one mean squared error. "
        "YUV 6:1:1: (6 Y + Cb + Cr) / 8 of BT.709, as in JPEG Pleno. worst view: the lowest of the "
        "PSNRs of the views of one (s,t). foreground: over the texels that differ from the most "
        "common one. rendered: over pictures of the paper's five views, drawn from both textures.",
        "max error: the largest of any sample, in 8-bit steps" +
            std::string(hdr ? ", or half-float ulps" : "") + ".",
        "enc, dec: MB of raw texture per second of wall-clock time, on all threads. A rival's time "
        "includes starting its tools, and reading and writing their files. Tessera's time is that "
        "of one pass in memory that verifies every tile. Decoding that takes less than half a "
        "second runs three times, and the best time counts.",
        "for a texel, for a view: bytes of the file that a reader must fetch for one texel, or for "
        "the U x V texels of one (s,t), if it already has the header and the index. tessera: the "
        "mean of 64 texels and of 8 views. Video: all frames from the key frame up to the wanted "
        "one, on average about half of a group. One file per view: that file. AVIF's mosaic and "
        "zfp at fixed accuracy: the whole file. zfp at fixed rate, ASTC and DWAA: the blocks or "
        "chunks that the texels touch.",
        "BD-rate: how many more bits a codec needs than the anchor at equal PSNR (Bjontegaard, "
        "logarithm of the rate, monotone cubic interpolation), over the PSNRs that both reach. A "
        "dash means that they share no PSNRs."};
    if (hdr)
        lines.push_back("Half floats: RGB is computed over the 16-bit codes. PU21 and log2 are "
                        "defined as in `tessera compare` (1.0 is 100 cd/m2).");
    return lines;
}

} // namespace tessera
