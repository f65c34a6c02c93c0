// The report as text, CSV and JSON.
#include "tools/lab/rd/report.h"

#include "tools/support/parse.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

std::string padded(const std::string& text, std::size_t width, bool left) {
    const std::string pad(width - std::min(width, text.size()), ' ');
    return left ? text + pad : pad + text;
}

// Makes each column as wide as its widest cell. A last column of notes is aligned left.
std::string table_text(const RdTable& table) {
    std::vector<std::size_t> widths;
    for (const std::string& title : table.titles)
        widths.push_back(title.size());
    for (const auto& row : table.rows)
        for (std::size_t c = 0; c < row.size(); ++c)
            widths[c] = std::max(widths[c], row[c].size());
    const bool words_last = table.titles.back() == "note";
    std::string text;
    const auto add = [&](const std::vector<std::string>& cells) {
        std::string line;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            const bool left = c < table.names || (words_last && c + 1 == cells.size());
            line += "  " + padded(cells[c], widths[c], left);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    };
    add(table.titles);
    for (const auto& row : table.rows)
        add(row);
    return text;
}

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos)
        return text;
    std::string out = "\"";
    for (const char c : text)
        out += c == '"' ? "\"\"" : std::string(1, c);
    return out + "\"";
}

// Writes six significant digits, "inf" for a lossless PSNR, and nothing for an absent value.
std::string number(const std::optional<double>& value) {
    if (!value)
        return "";
    if (!std::isfinite(*value))
        return "inf";
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", *value);
    return text;
}

std::string csv_row(const TextureReport& texture, const Measurement& m) {
    const CodecInfo* info = texture.codec(m.codec);
    std::vector<std::string> cells = {
        texture.name, texture.size, m.codec, info ? info->version : "", info ? info->layout : "",
        m.setting};
    if (!m.failed.empty()) {
        cells.resize(cells.size() + 15);
        cells.push_back("failed: " + m.failed);
    } else {
        const Quality& q = m.quality;
        cells.push_back(std::to_string(m.bytes));
        for (const std::optional<double>& value :
             {std::optional(m.bits_per_texel), std::optional(q.psnr_rgb), q.psnr_yuv,
              std::optional(q.psnr_worst_view), q.psnr_foreground, q.psnr_rendered, q.psnr_pu21,
              q.psnr_log2})
            cells.push_back(number(value));
        cells.push_back(std::to_string(q.max_error));
        for (const std::optional<double>& value :
             {std::optional(m.encode_mbs), std::optional(m.decode_mbs), m.texel_bytes,
              m.view_bytes})
            cells.push_back(number(value));
        cells.push_back(m.cached ? "1" : "0");
        cells.push_back(m.note);
    }
    std::string line;
    for (const std::string& cell : cells)
        line += (line.empty() ? "" : ",") + quoted(cell);
    return line + "\n";
}

Json bd_json(const std::optional<BdRate>& rate) {
    if (!rate)
        return nullptr;
    return {{"percent", rate->percent}, {"from_dB", rate->low}, {"to_dB", rate->high}};
}

Json to_json(const TextureReport& t) {
    Json json = {
        {"name", t.name},           {"size", t.size},
        {"type", t.type},           {"channels", t.channels},
        {"raw_bytes", t.raw_bytes}, {"crop", t.crop.empty() ? Json(nullptr) : Json(t.crop)},
        {"checksum", t.checksum},   {"background_share", t.background_share},
        {"codecs", Json::array()},  {"measurements", Json::array()},
        {"absent", Json::array()},  {"anchor", t.anchor},
        {"bd_rate", Json::array()}};
    for (const CodecInfo& info : t.codecs)
        json["codecs"].push_back(
            {{"id", info.id}, {"layout", info.layout}, {"version", info.version}});
    for (const Measurement& m : t.rows)
        json["measurements"].push_back(to_json(m));
    for (const RivalChoice::Absent& a : t.absent)
        json["absent"].push_back({{"id", a.id}, {"reason", a.reason}});
    for (const BdRow& row : bd_rows(t))
        json["bd_rate"].push_back({{"codec", row.codec},
                                   {"psnr_rgb", bd_json(row.rgb)},
                                   {"psnr_yuv611", bd_json(row.yuv)},
                                   {"psnr_worst_view", bd_json(row.worst_view)},
                                   {"psnr_foreground", bd_json(row.foreground)},
                                   {"psnr_rendered", bd_json(row.rendered)},
                                   {"psnr_pu21", bd_json(row.pu21)},
                                   {"psnr_log2", bd_json(row.log2)}});
    return json;
}

} // namespace

std::string to_text(const RdReport& report) {
    std::string text;
    for (const TextureReport& t : report.textures) {
        text += t.name + ": " + t.size + ", " + std::to_string(t.channels) + " x " + t.type + ", " +
                human_bytes(t.raw_bytes) + " raw" + (t.crop.empty() ? "" : ", a crop: " + t.crop) +
                "; " + format_number(t.background_share * 100, 1) + " % background\n\n";
        text += table_text(measurement_table(t)) + "\n";
        text += "BD-rate against " + t.anchor + "\n" + table_text(bd_table(t)) + "\n";
        text += "Speed against error, near " + format_number(speed_psnr, 0) + " dB\n" +
                table_text(speed_table(t)) + "\n";
        for (const RivalChoice::Absent& a : t.absent)
            text += "  " + a.id + ": " + a.reason + "\n";
        text += t.absent.empty() ? "" : "\n";
    }
    return text;
}

std::string to_csv(const RdReport& report) {
    std::string text =
        "texture,size,codec,version,layout,setting,bytes,bits_per_texel,psnr_rgb,psnr_yuv611,"
        "psnr_worst_view,psnr_foreground,psnr_rendered,psnr_pu21,psnr_log2,max_error,encode_MBps,"
        "decode_MBps,bytes_for_one_texel,bytes_for_one_view,cached,note\n";
    for (const TextureReport& texture : report.textures) {
        for (const Measurement& m : texture.rows)
            text += csv_row(texture, m);
        for (const RivalChoice::Absent& a : texture.absent)
            text += quoted(texture.name) + "," + texture.size + "," + a.id + std::string(19, ',') +
                    quoted(a.reason) + "\n";
    }
    return text;
}

Json to_json(const RdReport& report) {
    Json json = {{"command", report.command},
                 {"machine", report.machine},
                 {"definitions", definitions(report)},
                 {"textures", Json::array()}};
    for (const TextureReport& texture : report.textures)
        json["textures"].push_back(to_json(texture));
    return json;
}

} // namespace tessera
