#include "tools/lab/bench/gpu_bench_report.h"

#include "tools/support/parse.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tessera {

Spread spread_of(std::vector<double> milliseconds) {
    if (milliseconds.empty())
        return {};
    std::sort(milliseconds.begin(), milliseconds.end());
    // The smallest time that at least `share` of all times do not exceed.
    const auto at = [&](double share) {
        const double rank = std::ceil(share * static_cast<double>(milliseconds.size()));
        return milliseconds[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
    };
    return {at(0.5), at(0.95)};
}

namespace {

// Lines of cells. Each column is as wide as its widest cell.
class Table {
public:
    explicit Table(std::vector<std::string> titles) { add(std::move(titles)); }
    void add(std::vector<std::string> cells) { lines_.push_back(std::move(cells)); }
    // Adds a line of fewer cells. Its last cell may extend over the other columns.
    void add_remark(std::vector<std::string> cells) {
        remarks_.push_back(lines_.size());
        add(std::move(cells));
    }
    // Aligns the first `names` columns left and the others right.
    std::string text(std::size_t names) const {
        std::vector<std::size_t> widths(lines_.front().size(), 0);
        for (std::size_t l = 0; l < lines_.size(); ++l) {
            const std::size_t run_on = is_remark(l) ? 1 : 0;
            for (std::size_t c = 0; c + run_on < lines_[l].size(); ++c)
                widths[c] = std::max(widths[c], lines_[l][c].size());
        }
        std::string text;
        for (const auto& line : lines_) {
            std::string row;
            for (std::size_t c = 0; c < line.size(); ++c) {
                const std::string gap(c == 0 ? 2 : 3, ' ');
                const std::string pad(widths[c] - std::min(widths[c], line[c].size()), ' ');
                row += c < names ? gap + line[c] + pad : gap + pad + line[c];
            }
            row.erase(row.find_last_not_of(' ') + 1);
            text += row + '\n';
        }
        return text;
    }

private:
    bool is_remark(std::size_t line) const {
        return std::find(remarks_.begin(), remarks_.end(), line) != remarks_.end();
    }
    std::vector<std::vector<std::string>> lines_;
    std::vector<std::size_t> remarks_;
};

std::string mib(std::uint64_t bytes) {
    return format_number(static_cast<double>(bytes) / (1 << 20), 1);
}
std::string count_text(double count) {
    return count == 0 ? "0" : format_number(count, count < 10 ? 2 : 1);
}
std::string rate_text(double texels_per_second) {
    const double mega = texels_per_second * 1e-6;
    return mega > 0 ? format_number(mega, mega < 10 ? 2 : 0) : "-";
}
std::string milliseconds_text(double milliseconds) {
    return format_number(milliseconds, milliseconds < 10 ? 3 : 1);
}
std::string psnr_text(const std::optional<double>& psnr) {
    if (!psnr)
        return "-";
    return std::isfinite(*psnr) ? format_number(*psnr, 2) : "same";
}

std::string rows_text(const BenchReport& r) {
    Table table({"texels", "fetches", "frame", "ms", "95 %", "wall ms", "95 %", "held MiB",
                 "tiles seen", "decoded", "late", "Mtexel/s", "PSNR dB"});
    for (const BenchRow& row : r.rows) {
        if (!row.missing.empty()) {
            table.add_remark({row.via, row.fetches, row.frame, row.missing});
            continue;
        }
        const bool cached = row.slots > 0;
        table.add({row.via, row.fetches, row.frame, milliseconds_text(row.device.median),
                   milliseconds_text(row.device.p95), milliseconds_text(row.wall.median),
                   milliseconds_text(row.wall.p95), mib(row.bytes),
                   cached ? count_text(row.touched) : "-", cached ? count_text(row.decoded) : "-",
                   cached ? count_text(row.waiting) : "-", rate_text(row.texels_per_second),
                   psnr_text(row.psnr)});
    }
    return table.text(3);
}

std::string parts_text(const BenchReport& r) {
    std::string text;
    for (const BenchRow& row : r.rows) {
        if (!row.missing.empty() || row.slots == 0)
            continue;
        const auto part = [](const char* name, const Spread& s) {
            return std::string(name) + " " + milliseconds_text(s.median);
        };
        text += "  " + row.via + ", " + row.fetches + ", " + row.frame + ": ";
        if (row.frame == "cold")
            text += part("marking frame", row.mark) + ", " + part("decoding", row.decode) + ", " +
                    part("drawing", row.redraw);
        else
            text += part("drawing", row.draw) + ", " + part("update", row.update);
        text += " ms; " + std::to_string(row.slots) + " slots\n";
    }
    return text.empty() ? text : "\nParts of a frame, medians\n" + text;
}

std::string decodes_text(const BenchReport& r) {
    Table table(
        {"decoding", "tiles", "upload ms", "entropy", "order", "transform", "whole", "Mtexel/s"});
    for (const BenchDecode& d : r.decodes) {
        if (!d.missing.empty()) {
            table.add_remark({d.what, d.missing});
            continue;
        }
        table.add({d.what, std::to_string(d.tiles), milliseconds_text(d.upload),
                   milliseconds_text(d.entropy), milliseconds_text(d.order),
                   milliseconds_text(d.transform), milliseconds_text(d.whole),
                   rate_text(d.whole > 0 ? static_cast<double>(d.texels) / d.whole * 1e3 : 0)});
    }
    return table.text(1);
}

Json to_json(const Spread& s) {
    return {{"median", s.median}, {"p95", s.p95}};
}

Json to_json(const BenchRow& row) {
    Json json = {{"via", row.via}, {"fetches", row.fetches}, {"frame", row.frame}};
    if (!row.missing.empty()) {
        json["missing"] = row.missing;
        return json;
    }
    json["device_ms"] = to_json(row.device);
    json["wall_ms"] = to_json(row.wall);
    if (row.slots > 0 && row.frame == "cold")
        json["parts_ms"] = {{"mark", to_json(row.mark)},
                            {"decode", to_json(row.decode)},
                            {"draw", to_json(row.redraw)}};
    else if (row.slots > 0)
        json["parts_ms"] = {{"draw", to_json(row.draw)}, {"update", to_json(row.update)}};
    json["bytes"] = row.bytes;
    if (row.slots > 0) {
        json["slots"] = row.slots;
        json["tiles_per_frame"] = {
            {"touched", row.touched}, {"decoded", row.decoded}, {"late", row.waiting}};
        json["texels_per_second"] =
            row.texels_per_second > 0 ? Json(row.texels_per_second) : Json(nullptr);
    }
    json["same_picture"] = row.psnr && !std::isfinite(*row.psnr);
    json["psnr"] = row.psnr && std::isfinite(*row.psnr) ? Json(*row.psnr) : Json(nullptr);
    return json;
}

Json to_json(const BenchDecode& d) {
    Json json = {{"what", d.what}};
    if (!d.missing.empty()) {
        json["missing"] = d.missing;
        return json;
    }
    json["tiles"] = d.tiles;
    json["texels"] = d.texels;
    json["stages_ms"] = {{"upload", d.upload},
                         {"entropy", d.entropy},
                         {"order", d.order},
                         {"transform", d.transform}};
    json["whole_ms"] = d.whole;
    json["texels_per_second"] =
        d.whole > 0 ? Json(static_cast<double>(d.texels) / d.whole * 1e3) : Json(nullptr);
    return json;
}

} // namespace

std::string to_text(const BenchReport& r) {
    std::string text = r.device + ", " + r.vendor + ", OpenGL " + r.driver + '\n';
    if (r.software)
        text += "This is a software device. Its timings say nothing about GPUs.\n";
    text += r.file + ": " + r.size + ", " + human_bytes(r.file_bytes) + ", " +
            format_number(r.bits_per_texel, 4) + " bits per texel, " + std::to_string(r.tiles) +
            " tiles";
    if (r.blocks > 0)
        text += ", " + std::to_string(r.blocks) + " blocks, " + std::to_string(r.coefficients) +
                " coefficients";
    text += "; decoded " + mib(r.decoded_bytes) + " MiB, cache budget " + mib(r.budget) + " MiB\n";
    text += std::to_string(r.width) + "x" + std::to_string(r.height) + " pixels, " +
            std::to_string(r.frames) + " frames after " + std::to_string(r.warm_up) + ", " +
            std::to_string(r.orbit) + " frames per turn; " + std::to_string(r.cold_frames) +
            " cold frames\n";
    text += "PSNR " + (r.reference.empty() ? "not measured" : "against " + r.reference) + "\n\n";
    text += rows_text(r) + parts_text(r);
    if (!r.decodes.empty()) {
        text += '\n';
        text += decodes_text(r);
    }
    return text;
}

Json to_json(const BenchReport& r) {
    Json json = {{"device", r.device},
                 {"vendor", r.vendor},
                 {"driver", r.driver},
                 {"software", r.software},
                 {"file", r.file},
                 {"size", r.size},
                 {"file_bytes", r.file_bytes},
                 {"bits_per_texel", r.bits_per_texel},
                 {"tiles", r.tiles},
                 {"blocks", r.blocks > 0 ? Json(r.blocks) : Json(nullptr)},
                 {"coefficients", r.blocks > 0 ? Json(r.coefficients) : Json(nullptr)},
                 {"decoded_bytes", r.decoded_bytes},
                 {"budget", r.budget},
                 {"width", r.width},
                 {"height", r.height},
                 {"frames", r.frames},
                 {"warm_up", r.warm_up},
                 {"cold_frames", r.cold_frames},
                 {"orbit", r.orbit},
                 {"reference", r.reference.empty() ? Json(nullptr) : Json(r.reference)},
                 {"rows", Json::array()},
                 {"decode", Json::array()}};
    for (const BenchRow& row : r.rows)
        json["rows"].push_back(to_json(row));
    for (const BenchDecode& decode : r.decodes)
        json["decode"].push_back(to_json(decode));
    return json;
}

} // namespace tessera
