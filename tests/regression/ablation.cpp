// Measures what each coding tool is worth: encodes without it, and writes tables between the two
// marks in ablation.md. tools/scripts/ablation.sh builds and runs it.
//   ablation ablation.md [PEERS.rgb]
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "format/texture.h"
#include "codec/tile_encoder/tool_switches.h"
#include "tests/regression/textures.h"
#include "tools/rd/bd_rate.h"

#include <cstdio>
#include <ctime>
#include <sstream>

using namespace tessera;

namespace {

constexpr int effort = 5;
constexpr unsigned threads = 0; // all cores; times are summed over them
constexpr const char* begin_mark = "<!-- tables -->\n";
constexpr const char* end_mark = "<!-- end of tables -->\n";

// Of the processor, not of the wall: machines are shared.
double seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// A texture, and the qualities that give about 33 to 42 dB (gallery, the hard one: 28 to 38).
struct Task {
    Texture texture;
    std::vector<double> qualities;
};

struct Curve {
    std::vector<RatePoint> points;
    double encode_seconds = 0, decode_seconds = 0; // of all points
};

Result<Curve> measure(const Task& task, const std::string& tools) {
    Curve curve;
    MemorySource source(task.texture.desc, task.texture.texels);
    std::vector<std::byte> texels(task.texture.texels.size());
    for (const double quality : task.qualities) {
        EncodeOptions options;
        options.rate = {RateTarget::Kind::quality, quality};
        options.effort = effort;
        options.tools = tools;
        options.threads = threads;
        std::vector<std::byte> file;
        const double begun = seconds();
        const auto report = encode_memory(source, file, options);
        if (!report)
            return report.status();
        curve.points.push_back({static_cast<double>(report->file_bytes), report->psnr});
        curve.encode_seconds += seconds() - begun;
        const auto bytes = wrap_memory(file);
        const auto decoder = Decoder::open(*bytes);
        if (!decoder)
            return decoder.status();
        double best = 1e9;
        for (int i = 0; i < 5; ++i) {
            const double start = seconds();
            TESSERA_TRY(decoder->decode_box(Box4::whole(decoder->desc().size), texels, threads));
            best = std::min(best, seconds() - start);
        }
        curve.decode_seconds += best;
    }
    return curve;
}

struct Experiment {
    std::string tools; // also its name
};

std::vector<Experiment> experiments() {
    std::vector<Experiment> all;
    for (const CodingToolInfo& info : coding_tools)
        all.push_back({std::string("-") + info.name});
    all.push_back({"none"});
    return all;
}

// A line as it stands in the table, also on standard output for who waits.
void add_line(std::string& table, const std::string& line) {
    table += line;
    std::fputs(line.c_str(), stdout);
    std::fflush(stdout);
}

std::string number(const char* format, double value) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

Status add_table(const Task& task, std::string& text) {
    const Result<Curve> full = measure(task, {});
    if (!full)
        return full.status();
    std::string psnrs, qualities;
    for (std::size_t i = 0; i < task.qualities.size(); ++i) {
        psnrs += number(i > 0 ? ", %.1f" : "%.1f", full->points[i].psnr);
        qualities += number(i > 0 ? ", %.0f" : "%.0f", task.qualities[i]);
    }
    const double megabytes =
        static_cast<double>(task.texture.texels.size() * task.qualities.size()) / 1e6;
    add_line(text, "\n**" + task.texture.name + "**, qualities " + qualities + ": " + psnrs +
                       " dB with all tools, encoding " +
                       number("%.2f", megabytes / full->encode_seconds) + " MB/s, decoding " +
                       number("%.0f", megabytes / full->decode_seconds) +
                       " MB/s\n\n| tools | BD-rate % | decoding speed | encoding time |\n"
                       "|---|---:|---:|---:|\n");
    for (const Experiment& experiment : experiments()) {
        const Result<Curve> curve = measure(task, experiment.tools);
        if (!curve)
            return curve.status().with_context(experiment.tools);
        const auto rate = bd_rate(full->points, curve->points);
        add_line(text, "| " + experiment.tools + " | " +
                           (rate ? number("%+.1f", rate->percent) : "no overlap") + " | " +
                           number("x %.2f", full->decode_seconds / curve->decode_seconds) + " | " +
                           number("x %.2f", curve->encode_seconds / full->encode_seconds) + " |\n");
    }
    return {};
}

// The middle 16x16 views: as many texels as the baked scenes have.
Result<Texture> load_middle_of_peers(const char* path) {
    Result<Texture> whole = load_peers(path);
    if (!whole)
        return whole;
    const Box4 box{{0, 0, 8, 8}, {128, 64, 24, 24}};
    Texture middle{"peers_composed, views 8..23", whole->desc, {}};
    middle.desc.size = {128, 64, 16, 16};
    middle.texels.resize(middle.desc.box_bytes(Box4::whole(middle.desc.size)));
    TESSERA_TRY(MemorySource(whole->desc, whole->texels).read(box, middle.texels));
    return middle;
}

Status run(const std::string& path, const char* peers) {
    std::ifstream in(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::size_t begin = text.find(begin_mark), end = text.find(end_mark);
    if (begin == std::string::npos || end == std::string::npos || end < begin)
        return {ErrorCode::io, path + ": lacks the marks between which tables stand"};
    std::string tables;
    const double start = seconds();
    const Extent4 size{128, 64, 16, 16};
    const std::vector<std::pair<const char*, std::vector<double>>> scenes = {
        {"composed", {46, 58, 68}},
        {"gallery", {50, 61, 71}},
        {"mirror", {58, 67, 75}},
        {"aliasing-near", {36, 46, 56}}};
    for (const auto& [scene, qualities] : scenes) {
        Result<Texture> texture = bake(scene, size);
        if (!texture)
            return texture.status();
        TESSERA_TRY(add_table({std::move(*texture), qualities}, tables));
    }
    if (peers != nullptr) {
        Result<Texture> texture = load_middle_of_peers(peers);
        if (!texture)
            return texture.status();
        TESSERA_TRY(add_table({std::move(*texture), {48, 58, 67}}, tables));
    }
    add_line(tables, "\nAll in one run of " + number("%.0f", (seconds() - start) / 60) +
                         " minutes of processor time.\n\n");
    text.replace(begin, end - begin, begin_mark + tables);
    std::ofstream out(path, std::ios::binary);
    out << text;
    return out.flush() ? Status() : Status(ErrorCode::io, "cannot write " + path);
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argc > 3) {
        std::fprintf(stderr, "usage: ablation ablation.md [PEERS.rgb]\n");
        return 1;
    }
    const Status status = run(argv[1], argc > 2 ? argv[2] : nullptr);
    if (!status.ok())
        std::fprintf(stderr, "ablation: error: %s\n", status.message().c_str());
    return static_cast<int>(status.code());
}
