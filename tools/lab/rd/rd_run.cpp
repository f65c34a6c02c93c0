#include "tools/lab/rd/rd_run.h"

#include "format/output_file.h"
#include "format/work.h"
#include "tools/lab/rd/plot.h"
#include "tools/lab/rd/sweep.h"
#include "tools/lab/rd/tessera_codec.h"
#include "tools/support/interrupt.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/system.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

namespace tessera {
namespace {

const std::vector<double> usual_psnrs = {35, 38, 41, 44};
// The table of speeds measures other efforts only at this setting. It gives about 39 dB on the
// composed scene.
constexpr const char* speed_setting = "quality 62";
const std::vector<int> speed_efforts = {0, usual_effort, most_effort}, quick_speed_efforts = {0, 1};

std::string trimmed(double value) {
    std::string text = format_number(value, 2);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.')
        text.pop_back();
    return text;
}

std::vector<std::string> tessera_settings(const RdOptions& o) {
    std::vector<std::string> settings;
    const bool usual = o.psnr.empty() && o.quality.empty();
    for (const double psnr : usual ? usual_psnrs : o.psnr)
        settings.push_back("psnr " + trimmed(psnr));
    for (const double quality : o.quality)
        settings.push_back("quality " + trimmed(quality));
    return settings;
}

std::vector<int> swept_efforts(const RdOptions& o) {
    if (!o.efforts.empty())
        return o.efforts;
    return {o.quick ? 1 : usual_effort};
}

// Curves for the requested efforts. If none were requested, a curve for the usual effort and single
// points at other efforts, for the table of speeds.
std::vector<CodecUnderTest> tessera_codecs(const RdOptions& o) {
    std::vector<CodecUnderTest> codecs;
    const std::vector<int> efforts = swept_efforts(o);
    for (const int effort : efforts)
        if (std::none_of(codecs.begin(), codecs.end(), [&](const CodecUnderTest& c) {
                return c.id == "tessera:" + std::to_string(effort);
            }))
            codecs.push_back(tessera_codec(effort, tessera_settings(o)));
    if (!o.efforts.empty())
        return codecs;
    for (const int effort : o.quick ? quick_speed_efforts : speed_efforts)
        if (effort != efforts.front()) {
            codecs.push_back(tessera_codec(effort, {speed_setting}));
            codecs.back().in_plot = false;
        }
    return codecs;
}

// Finds the codec that --anchor names, by its id or by the part of its id before the colon.
Result<std::string> anchor_among(const RdOptions& o, const std::vector<CodecUnderTest>& codecs,
                                 const std::vector<Measurement>& rows) {
    const auto ran = [&](const std::string& id) {
        return std::any_of(rows.begin(), rows.end(),
                           [&](const Measurement& m) { return m.codec == id && m.failed.empty(); });
    };
    if (o.anchor.empty()) {
        for (const std::string id : {"x265", "x265:medium", "avif", "avif:planes"})
            if (o.pictures == id.starts_with("avif") && ran(id))
                return id;
        return codecs.front().id;
    }
    for (const CodecUnderTest& codec : codecs)
        if (codec.id == o.anchor)
            return codec.id;
    for (const CodecUnderTest& codec : codecs)
        if (codec.id.starts_with(o.anchor + ":"))
            return codec.id;
    return Status(ErrorCode::bad_argument, "--anchor: '" + o.anchor + "' was not measured");
}

std::string machine_text(unsigned threads) {
    std::string line, model = "unknown processor";
    std::ifstream info("/proc/cpuinfo");
    while (std::getline(info, line))
        if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos) {
            model = line.substr(line.find(": ") + 2);
            break;
        }
    return model + ", " + std::to_string(thread_count(threads)) + " threads";
}

std::string command_text(const RdOptions& o) {
    std::string text = "tessera rd";
    for (const std::string& name : o.textures)
        text += " " + name;
    if (o.hints.size)
        text += " --size " + to_string(*o.hints.size);
    return text + (o.on_sphere ? " --sphere" : "") + (o.quick ? " --quick" : "") +
           (o.pictures ? " --pictures" : "") + (o.rivals.empty() ? "" : " --rivals " + o.rivals) +
           " -o " + o.output;
}

// Lines on standard output between redrawings of the bar on standard error.
void print_line(const Measurement& m, std::size_t number, std::size_t count) {
    if (is_terminal(StandardStream::error))
        std::fputs("\r\x1b[K", stderr);
    const std::string head = "[" + std::to_string(number) + "/" + std::to_string(count) + "] " +
                             m.codec + " " + m.setting;
    if (!m.failed.empty())
        std::printf("%-36s failed: %s\n", head.c_str(), m.failed.c_str());
    else
        std::printf("%-36s %9.5f bpt %8s  encoding %8.2f MB/s, decoding %8.2f MB/s%s\n",
                    head.c_str(), m.bits_per_texel,
                    std::isfinite(m.quality.psnr_rgb)
                        ? (format_number(m.quality.psnr_rgb, 2) + " dB").c_str()
                        : "exact",
                    m.encode_mbs, m.decode_mbs, m.cached ? "  cached" : "");
    std::fflush(stdout);
}

SweepOptions sweep_options(const RdOptions& o, std::optional<Progress>& bar) {
    SweepOptions s;
    s.threads = o.hints.threads;
    s.timeout = o.timeout;
    s.cache = o.cache.empty() ? o.output + "/cache" : o.cache;
    s.keep_folder = o.keep ? o.output + "/bitstreams" : "";
    s.progress = [&bar, &o](std::size_t number, std::size_t count, const std::string& what) {
        bar.emplace("tessera rd: " + std::to_string(number) + " of " + std::to_string(count) +
                        ", " + what,
                    o.quiet);
        return bar->function();
    };
    if (o.print_lines)
        s.done = print_line;
    return s;
}

TextureReport describe(const RdTexture& texture) {
    TextureReport r;
    r.name = texture.name;
    r.size = to_string(texture.desc.size);
    r.type = name_of(texture.desc.type);
    r.channels = texture.desc.channels;
    r.crop = texture.crop;
    r.checksum = texture.checksum;
    r.raw_bytes = texture.texels.size();
    r.background_share = texture.background_share;
    r.rendered = texture.window.has_value();
    return r;
}

Result<TextureReport> measure_texture(const RdOptions& o, const std::string& name,
                                      const std::vector<Rival>& rivals) {
    std::optional<Progress> bar;
    bar.emplace("tessera rd", o.quiet);
    const auto texture =
        load_rd_texture({name, o.samples, o.on_sphere, o.quick, o.hints}, bar->function());
    bar.reset();
    TESSERA_TRY(texture);
    if (o.pictures && (texture->desc.size[axis_s] > 1 || texture->desc.size[axis_t] > 1))
        return Status(ErrorCode::bad_argument, name +
                                                   ": --pictures accepts textures of one view, "
                                                   "but this one has " +
                                                   std::to_string(texture->desc.size[axis_s]) +
                                                   "x" +
                                                   std::to_string(texture->desc.size[axis_t]));
    TextureReport report = describe(*texture);
    std::vector<CodecUnderTest> codecs = tessera_codecs(o);
    RivalChoice choice = choose_rivals(rivals, texture->desc);
    codecs.insert(codecs.end(), choice.present.begin(), choice.present.end());
    report.absent = choice.absent;
    if (o.print_lines) {
        std::printf("%s, %s\n", report.name.c_str(), report.size.c_str());
        for (const RivalChoice::Absent& absent : report.absent)
            std::printf("%s: %s\n", absent.id.c_str(), absent.reason.c_str());
    }
    auto rows = sweep(*texture, codecs, sweep_options(o, bar));
    bar.reset();
    TESSERA_TRY(rows);
    TESSERA_TRY_ASSIGN(report.anchor, anchor_among(o, codecs, *rows));
    report.rows = std::move(*rows);
    for (const CodecUnderTest& codec : codecs)
        report.codecs.push_back({codec.id, codec.layout, codec.version, codec.in_plot});
    return report;
}

Status write_text(const std::string& path, const std::string& text) {
    return write_bytes(path, std::as_bytes(std::span(text)));
}

Status write_report(const std::string& folder, const RdReport& report) {
    for (std::size_t i = 0; i < report.textures.size(); ++i) {
        const std::string name = folder + "/rd" + (i == 0 ? "" : "-" + std::to_string(i + 1));
        TESSERA_TRY(write_text(name + ".svg", to_svg(report.textures[i])));
        const std::string close_up = to_svg(report.textures[i], PlotPart::close_up);
        if (!close_up.empty())
            TESSERA_TRY(write_text(name + "-close.svg", close_up));
    }
    TESSERA_TRY(write_text(folder + "/rd.csv", to_csv(report)));
    TESSERA_TRY(write_text(folder + "/rd.json",
                           to_json(report).dump(1, ' ', false, Json::error_handler_t::replace)));
    return write_text(folder + "/index.html", to_page(report));
}

// What --pictures means where other options say nothing.
RdOptions of_pictures(RdOptions options) {
    if (options.psnr.empty() && options.quality.empty())
        options.quality = {40, 48, 56, 64, 72, 78};
    if (options.efforts.empty())
        options.efforts = {most_effort};
    if (options.rivals.empty())
        options.rivals = "avif,avif:planes,jxl";
    return options;
}

} // namespace

Result<RdReport> run_rd(const RdOptions& requested) {
    const RdOptions options = requested.pictures ? of_pictures(requested) : requested;
    TESSERA_TRY_ASSIGN(const auto rivals, rivals_named(!options.rivals.empty() ? options.rivals
                                                       : options.quick         ? "quick"
                                                                               : "all"));
    for (const std::string& name : options.textures)
        TESSERA_TRY(check_rd_name(name));
    std::error_code error;
    std::filesystem::create_directories(to_path(options.output), error);
    if (error)
        return Status(ErrorCode::io, options.output + ": cannot be created: " + error.message());
    RdReport report;
    report.command = command_text(options);
    report.machine = machine_text(options.hints.threads);
    for (const std::string& name : options.textures) {
        TESSERA_TRY_ASSIGN(auto texture, measure_texture(options, name, rivals));
        report.textures.push_back(std::move(texture));
    }
    TESSERA_TRY(write_report(options.output, report));
    return report;
}

} // namespace tessera
