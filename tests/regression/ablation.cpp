// Measures what each coding tool gains: encodes without the tool, and writes a table between two
// marks in ablation.md. tools/lab/scripts/ablation.sh builds and runs this program.
//   ablation ablation.md [--size UxVxSxT] [--scenes NAME,...] [--tools NAME,... | --efforts N,...]
//            [TEXTURE_UxVxSxT.rgb[:Q,Q,Q]]...
// It bakes scenes of the given size and reads the given textures. These are raw 8-bit RGB files
// whose names end in their size, with the qualities that give about 33 to 42 dB. Without --tools it
// measures each tool, and an encoder without any tools. --efforts compares the efforts with the
// first one instead, and has marks of its own.
#include "codec/decoder.h"
#include "codec/encode/encode_with_tools.h"
#include "codec/encoder.h"
#include "codec/tile_encoder/tool_switches.h"
#include "format/texture.h"
#include "tests/regression/textures.h"
#include "tools/lab/rd/bd_rate.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sstream>

using namespace tessera;

namespace {

constexpr unsigned threads = 0; // all cores

struct Marks {
    const char *begin, *end;
};
constexpr Marks tool_marks{"<!-- tables -->\n", "<!-- end of tables -->\n"};
constexpr Marks effort_marks{"<!-- efforts -->\n", "<!-- end of efforts -->\n"};

// Processor time of all threads, because wall-clock time depends on other programs.
double seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// A texture, and the qualities that give about 33 to 42 dB (28 to 38 dB for gallery).
struct Task {
    Texture texture;
    std::vector<double> qualities;
};

struct Experiment {
    std::string name;
    ToolSwitches tools{};
    int effort = EncodeOptions().effort;
    bool small_tiles = false; // textures of one view have tiles of 64x64
};

struct Curve {
    std::vector<RatePoint> points;
    double encode_seconds = 0, decode_seconds = 0; // sums over all points
};

bool is_picture(const Extent4& size) {
    return size[axis_s] == 1 && size[axis_t] == 1;
}

Result<Curve> measure(const Task& task, const Experiment& experiment) {
    Curve curve;
    MemorySource source(task.texture.desc, task.texture.texels);
    std::vector<std::byte> texels(task.texture.texels.size());
    for (const double quality : task.qualities) {
        EncodeOptions options;
        options.rate = {RateTarget::Kind::quality, quality};
        options.effort = experiment.effort;
        options.threads = threads;
        if (experiment.small_tiles && is_picture(task.texture.desc.size))
            options.tile_extent = {64, 64, 1, 1};
        std::vector<std::byte> file;
        const double begun = seconds();
        const auto report = encode_memory(source, file, options, experiment.tools);
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
            TESSERA_TRY(decoder->decode_box(Box4::whole(decoder->desc().size), texels,
                                            {.threads = threads}));
            best = std::min(best, seconds() - start);
        }
        curve.decode_seconds += best;
    }
    return curve;
}

struct Request {
    Extent4 scene_size{128, 64, 16, 16};
    std::vector<std::string> scenes; // empty: all
    std::vector<std::string> tools;  // empty: all
    std::vector<int> efforts;        // if not empty, measured instead of tools
    std::vector<Task> textures;      // measured after the scenes
};

bool is_wanted(const std::vector<std::string>& names, const std::string& name) {
    return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

// The experiment that the others are compared with.
Experiment anchor_of(const Request& request) {
    if (request.efforts.empty())
        return {"all tools", {}};
    return {"effort " + std::to_string(request.efforts[0]), {}, request.efforts[0]};
}

std::vector<Experiment> experiments(const Request& request) {
    std::vector<Experiment> all;
    for (std::size_t i = 1; i < request.efforts.size(); ++i)
        all.push_back({std::to_string(request.efforts[i]), {}, request.efforts[i]});
    if (!request.efforts.empty())
        return all;
    for (std::size_t i = 0; i < coding_tool_names.size(); ++i) {
        const std::string name = coding_tool_names[i];
        if (!is_wanted(request.tools, name))
            continue;
        all.push_back({"-" + name, {}});
        all.back().tools.set(static_cast<CodingTool>(i), false);
    }
    if (request.tools.empty()) {
        all.push_back({"-large-tiles", {}});
        all.back().small_tiles = true;
        all.push_back({"none", {}});
        all.back().tools.set_all(false);
    }
    return all;
}

std::string number(const char* format, double value) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

// "46, 58, 68"
std::string list_of(const char* format, const std::vector<double>& values) {
    std::string text;
    for (const double value : values)
        text += (text.empty() ? "" : ", ") + number(format, value);
    return text;
}

// Measures a texture: one cell per heading of rows_of(). Prints each cell to show the progress.
Result<std::vector<std::string>> measure_column(const Task& task, const Request& request) {
    const Result<Curve> full = measure(task, anchor_of(request));
    if (!full)
        return full.status();
    std::vector<double> psnrs;
    for (const RatePoint& point : full->points)
        psnrs.push_back(point.psnr);
    const double megabytes =
        static_cast<double>(task.texture.texels.size() * task.qualities.size()) / 1e6;
    std::vector<std::string> cells = {task.texture.name, list_of("%.0f", task.qualities),
                                      list_of("%.1f", psnrs),
                                      number("%.2f", megabytes / full->encode_seconds) + ", " +
                                          number("%.0f", megabytes / full->decode_seconds)};
    std::printf("%s\n", cells.front().c_str());
    for (const Experiment& experiment : experiments(request)) {
        const Result<Curve> curve = measure(task, experiment);
        if (!curve)
            return curve.status().with_context(experiment.name);
        const auto rate = bd_rate(full->points, curve->points);
        cells.push_back((rate ? number("%+.1f", rate->percent) : "no overlap") + "/" +
                        number("%.2f", full->decode_seconds / curve->decode_seconds) + "/" +
                        number("%.2f", curve->encode_seconds / full->encode_seconds));
        std::printf("%s: %s\n", experiment.name.c_str(), cells.back().c_str());
        std::fflush(stdout);
    }
    return cells;
}

// The headings of the table's rows.
std::vector<std::string> rows_of(const Request& request) {
    const std::string anchor = anchor_of(request).name;
    std::vector<std::string> rows = {"texture", "qualities", anchor + ": dB",
                                     anchor + ": encoding, decoding MB/s"};
    for (const Experiment& experiment : experiments(request))
        rows.push_back(experiment.name);
    return rows;
}

// `columns` has one column per texture, as from measure_column().
std::string table_of(const std::vector<std::string>& rows,
                     const std::vector<std::vector<std::string>>& columns) {
    std::string table = "\n";
    for (std::size_t row = 0; row < rows.size(); ++row) {
        table += "| " + rows[row] + " |";
        for (const std::vector<std::string>& column : columns)
            table += " " + column[row] + " |";
        table += "\n";
        for (std::size_t i = 0; row == 0 && i <= columns.size(); ++i)
            table += i < columns.size() ? "|---" : "|---|\n";
    }
    return table + "\n";
}

bool parse_size(const char* text, Extent4& size) {
    return std::sscanf(text, "%ux%ux%ux%u", &size[0], &size[1], &size[2], &size[3]) == 4 &&
           size[0] > 0 && size[1] > 0 && size[2] > 0 && size[3] > 0;
}

std::vector<std::string> split_at_commas(const std::string& text) {
    std::vector<std::string> parts;
    std::istringstream in(text);
    for (std::string part; std::getline(in, part, ',');)
        parts.push_back(part);
    return parts;
}

// `argument`: TEXTURE_UxVxSxT.rgb[:Q,Q,Q]
Result<Task> load(const std::string& argument) {
    const std::size_t colon = argument.rfind(':');
    const std::string path = argument.substr(0, colon);
    const std::size_t name = path.rfind('/') + 1, last = path.rfind('_'), dot = path.rfind('.');
    Task task{{}, {48, 58, 67}};
    TextureDesc& desc = task.texture.desc;
    desc = {{}, SampleType::unorm8, 3};
    if (last == std::string::npos || dot == std::string::npos || dot < last ||
        !parse_size(path.c_str() + last + 1, desc.size))
        return Status(ErrorCode::bad_argument,
                      path + ": the name must end in its size, as in a_128x128x9x9.rgb");
    if (colon != std::string::npos) {
        task.qualities.clear();
        for (const std::string& quality : split_at_commas(argument.substr(colon + 1)))
            task.qualities.push_back(std::atof(quality.c_str()));
    }
    task.texture.name = path.substr(name, dot - name);
    task.texture.texels.resize(desc.box_bytes(Box4::whole(desc.size)));
    std::ifstream file(path, std::ios::binary);
    if (!file.read(reinterpret_cast<char*>(task.texture.texels.data()),
                   static_cast<std::streamsize>(task.texture.texels.size())))
        return Status(ErrorCode::io,
                      path + ": cannot be read or is too short for the size in its name");
    return task;
}

Status run(const std::string& path, const Request& request) {
    std::ifstream in(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const Marks& marks = request.efforts.empty() ? tool_marks : effort_marks;
    const std::size_t begin = text.find(marks.begin), end = text.find(marks.end);
    if (begin == std::string::npos || end == std::string::npos || end < begin)
        return {ErrorCode::io, path + ": lacks the marks for the tables"};
    std::vector<std::vector<std::string>> columns;
    const double start = seconds();
    const std::vector<std::pair<const char*, std::vector<double>>> scenes = {
        {"composed", {46, 58, 68}},
        {"gallery", {50, 61, 71}},
        {"mirror", {58, 67, 75}},
        {"aliasing-near", {36, 46, 56}}};
    for (const auto& [scene, qualities] : scenes) {
        if (!is_wanted(request.scenes, scene))
            continue;
        Result<Texture> texture = bake(scene, request.scene_size);
        if (!texture)
            return texture.status();
        TESSERA_TRY_ASSIGN(columns.emplace_back(),
                           measure_column({std::move(*texture), qualities}, request));
    }
    for (const Task& task : request.textures) {
        TESSERA_TRY_ASSIGN(columns.emplace_back(), measure_column(task, request));
    }
    std::printf("%.0f minutes of processor time\n", (seconds() - start) / 60);
    text.replace(begin, end - begin, marks.begin + table_of(rows_of(request), columns));
    std::ofstream out(path, std::ios::binary);
    out << text;
    return out.flush() ? Status() : Status(ErrorCode::io, "cannot write " + path);
}

Result<Request> parse(int argc, char** argv) {
    Request request;
    for (int i = 2; i < argc; ++i) {
        const bool has_value = i + 1 < argc;
        if (std::strcmp(argv[i], "--size") == 0 && has_value) {
            if (!parse_size(argv[++i], request.scene_size))
                return Status(ErrorCode::bad_argument, "--size: must be UxVxSxT");
        } else if (std::strcmp(argv[i], "--scenes") == 0 && has_value) {
            request.scenes = split_at_commas(argv[++i]);
        } else if (std::strcmp(argv[i], "--tools") == 0 && has_value) {
            request.tools = split_at_commas(argv[++i]);
            for (const std::string& name : request.tools)
                if (std::ranges::find(coding_tool_names, name) == coding_tool_names.end())
                    return Status(ErrorCode::bad_argument, "--tools: unknown tool " + name);
        } else if (std::strcmp(argv[i], "--efforts") == 0 && has_value) {
            for (const std::string& effort : split_at_commas(argv[++i]))
                request.efforts.push_back(std::atoi(effort.c_str()));
        } else {
            Result<Task> task = load(argv[i]);
            if (!task)
                return task.status();
            request.textures.push_back(std::move(*task));
        }
    }
    return request;
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: ablation ablation.md [--size UxVxSxT] [--scenes NAME,...] "
                             "[--tools NAME,... | --efforts N,...] "
                             "[TEXTURE_UxVxSxT.rgb[:Q,Q,Q]]...\n");
        return 1;
    }
    const Result<Request> request = parse(argc, argv);
    const Status status = request ? run(argv[1], *request) : request.status();
    if (!status.ok())
        std::fprintf(stderr, "ablation: error: %s\n", status.message().c_str());
    return static_cast<int>(status.code());
}
