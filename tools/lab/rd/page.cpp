// The report as one self-contained HTML file.
#include "tools/lab/rd/plot.h"
#include "tools/lab/rd/report.h"
#include "tools/support/html_text.h"
#include "tools/support/parse.h"

namespace tessera {
namespace {

const char* const style = R"(
:root { color-scheme: light; }
body { font: 15px/1.5 Helvetica, Arial, sans-serif; color: #1b2127; background: #fafbfc;
       margin: 0 auto; max-width: 1180px; padding: 24px 28px 60px; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 20px; margin: 36px 0 4px; }
h3 { font-size: 16px; margin: 26px 0 6px; } p { margin: 4px 0 10px; } .quiet { color: #56616c; }
.crop { background: #fff4d6; border-left: 4px solid #e0a800; padding: 8px 12px; }
figure { margin: 14px 0; background: #fff; border: 1px solid #e3e6ea; border-radius: 6px;
         padding: 8px; } figure svg { width: 100%; height: auto; }
.table { overflow-x: auto; } table { border-collapse: collapse; background: #fff;
         border: 1px solid #e3e6ea; font-size: 13px; }
th, td { padding: 4px 10px; text-align: right; white-space: nowrap;
         font-variant-numeric: tabular-nums; border-bottom: 1px solid #eef0f2; }
th { background: #f1f3f5; } .word { text-align: left; } .note { text-align: left; color: #56616c; }
tr.ours td { background: #fdeef0; } tr:hover td { background: #eef5ff; }
code { background: #eef0f2; padding: 1px 5px; border-radius: 3px; overflow-wrap: anywhere; }
)";

std::string paragraph(const std::string& text, const char* css_class = "") {
    return std::string("<p") + (*css_class ? std::string(" class=\"") + css_class + "\"" : "") +
           ">" + html_text(text) + "</p>\n";
}

std::string table_html(const RdTable& table) {
    const auto css = [&](std::size_t c) {
        const std::string& title = table.titles[c];
        return title == "note" || title == "layout" ? " class=\"note\""
               : c < table.names                    ? " class=\"word\""
                                                    : "";
    };
    std::string html = "<div class=\"table\"><table>\n<tr>";
    for (std::size_t c = 0; c < table.titles.size(); ++c)
        html += std::string("<th") + css(c) + ">" + html_text(table.titles[c]) + "</th>";
    html += "</tr>\n";
    for (const auto& row : table.rows) {
        html += row.front().rfind("tessera", 0) == 0 ? "<tr class=\"ours\">" : "<tr>";
        for (std::size_t c = 0; c < row.size(); ++c)
            html += std::string("<td") + css(c) + ">" + html_text(row[c]) + "</td>";
        html += "</tr>\n";
    }
    return html + "</table></div>\n";
}

std::string texture_html(const TextureReport& t) {
    std::string html = "<h2>" + html_text(t.name) + "</h2>\n";
    html += paragraph(t.size + ", " + std::to_string(t.channels) + " channels of " + t.type + ", " +
                          human_bytes(t.raw_bytes) + " raw; " +
                          format_number(t.background_share * 100, 1) +
                          " % of the texels are background. Checksum " + t.checksum + ".",
                      "quiet");
    if (!t.crop.empty())
        html += paragraph("Only a crop from the middle was measured: " + t.crop +
                              ". All codecs do worse on it than on the whole texture.",
                          "crop");
    for (const PlotPart part : {PlotPart::whole, PlotPart::close_up})
        if (const std::string svg = to_svg(t, part); !svg.empty())
            html += "<figure>\n" + svg + "</figure>\n";
    html += "<h3>BD-rate against " + html_text(t.anchor) + "</h3>\n" + table_html(bd_table(t));
    html += "<h3>Speed against error, at the setting nearest " + format_number(speed_psnr, 0) +
            " dB</h3>\n" + table_html(speed_table(t));
    html += "<h3>All measurements</h3>\n" + table_html(measurement_table(t));
    RdTable codecs;
    codecs.titles = {"codec", "version", "layout"};
    codecs.names = 2;
    for (const CodecInfo& info : t.codecs)
        codecs.rows.push_back({info.id, info.version, info.layout});
    html += "<h3>Layout of the texels for each codec</h3>\n" + table_html(codecs);
    if (t.absent.empty())
        return html;
    html += "<h3>Not measured</h3>\n<ul>\n";
    for (const RivalChoice::Absent& a : t.absent)
        html += "<li><b>" + html_text(a.id) + "</b>: " + html_text(a.reason) + "</li>\n";
    return html + "</ul>\n";
}

} // namespace

std::string to_page(const RdReport& report) {
    std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                       "<meta name=\"viewport\" content=\"width=device-width\">"
                       "<title>Tessera: rate and distortion</title>\n<style>";
    html += style;
    html += "</style></head><body>\n<h1>Rate and distortion</h1>\n";
    html += "<p class=\"quiet\"><code>" + html_text(report.command) + "</code><br>" +
            html_text(report.machine) + "</p>\n";
    for (const TextureReport& texture : report.textures)
        html += texture_html(texture);
    html += "<h2>What the figures mean</h2>\n<ul>\n";
    for (const std::string& line : definitions(report))
        html += "<li>" + html_text(line) + "</li>\n";
    return html + "</ul>\n</body></html>\n";
}

} // namespace tessera
