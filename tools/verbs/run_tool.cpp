#include "tools/verbs/command.h"

#include "format/metadata.h"
#include "tools/support/parse.h"
#include "tools/support/suggestions.h"
#include "tools/support/usage_error.h"

#include <algorithm>
#include <cstdio>
#include <sstream>
#include <vector>

namespace tessera {
namespace {

const char* const main_help =
    "A texture has U x V points on a surface and, for each of them, S x T directions in which "
    "light "
    "leaves it. A view is the picture of all points in one direction; an angular image shows all "
    "directions of one point. Boxes are half-open ranges: 0:64,0:64,:,: (':' is a whole axis). K, "
    "M, "
    "G and T in sizes are powers of 1024.\n\n"
    "Kinds of textures; compressed ones are recognised by their content, others by name:\n"
    "  x.tess   compressed; also as a URL (http, https)\n"
    "  x.glb    a glTF file that holds a .tess; also as a URL\n"
    "  x.exr    one OpenEXR picture with the angular images side by side\n"
    "  views/   a folder with one picture per view; a single PNG is one view\n"
    "  x.rgb    raw samples in the order v, u, t, s with interleaved channels; needs --size. Also "
    ".rgba .gray .ya, each also with 16f behind it for half floats, and .raw, which needs --type "
    "and "
    "--channels\n"
    "  -        standard input, or standard output: a .tess from encode and bake, raw samples from "
    "decode\n\n"
    "Examples:\n"
    "  tessera bake composed -o scene.tess --size 256x128x16x16\n"
    "  tessera encode views/ -o scene.tess --target-psnr 40\n"
    "  tessera info scene.tess\n"
    "  tessera decode scene.tess -o views/\n"
    "tessera VERB --help explains a verb.\n\n";

// Breaks a line between words so that it fits `width`. Further lines begin at column `indent`.
std::string wrapped(std::string line, std::size_t width, std::size_t indent = 0) {
    for (std::size_t begin = 0; line.size() - begin > width;) {
        const std::size_t blank = line.rfind(' ', begin + width);
        if (blank == line.npos || blank <= begin + indent)
            break;
        line.replace(blank, 1, "\n" + std::string(indent, ' '));
        begin = blank + 1;
    }
    return line;
}

// CLI11's help, wrapped to the lines of a terminal.
class HelpFormatter : public CLI::Formatter {
public:
    HelpFormatter() { column_width(names_width); }
    std::string make_option_desc(const CLI::Option* option) const override {
        return wrapped(CLI::Formatter::make_option_desc(option), line_width - names_width);
    }
    // An indented line is an example or an entry of a list: a name, blanks and a text.
    std::string make_footer(const CLI::App* app) const override {
        std::istringstream lines(app->get_footer());
        std::string text = "\n";
        for (std::string line; std::getline(lines, line);) {
            const std::size_t gap = line.starts_with("  ") ? line.find("  ", 2) : line.npos;
            const std::size_t entry = gap == line.npos ? 0 : line.find_first_not_of(' ', gap);
            text += wrapped(line, line_width, entry) + "\n";
        }
        return text;
    }
    // With one blank line between headings instead of two.
    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode mode) const override {
        std::string text = CLI::Formatter::make_help(app, name, mode);
        for (std::size_t at; (at = text.find("\n\n\n")) != text.npos;)
            text.erase(at, 1);
        return text;
    }

private:
    static constexpr std::size_t names_width = 28, line_width = 100;
};

std::string version_text() {
    return std::string("tessera ") + library_version + ", file format " +
           std::to_string(format_version_major) + "." + std::to_string(format_version_minor);
}

constexpr const char* help_verb = "help";
constexpr const char* version_verb = "version";

std::vector<std::string> names_of(std::span<const Verb> verbs) {
    std::vector<std::string> names;
    for (const Verb& verb : verbs)
        names.push_back(verb.name);
    names.insert(names.end(), {help_verb, version_verb});
    return names;
}

int report(const std::string& verb, const Status& status) {
    if (status.ok())
        return 0;
    std::fprintf(stderr, "tessera%s%s: error: %s\n", verb.empty() ? "" : " ", verb.c_str(),
                 printable(status.message()).c_str()); // it may quote a file
    const ErrorCode code = status.code();
    return static_cast<int>(code == ErrorCode::over_budget ? ErrorCode::unsupported : code);
}

bool is_among(const std::vector<std::string>& names, const std::string& word) {
    return std::find(names.begin(), names.end(), word) != names.end();
}

Status unknown_verb(const std::vector<std::string>& names, const std::string& word) {
    return {ErrorCode::bad_argument,
            "unknown verb " + word + did_you_mean(word, names) + " (tessera help lists all)"};
}

void add_verbs(CLI::App& app, std::span<const Verb> verbs, Invocation& chosen) {
    for (const Verb& verb : verbs)
        verb.add(app, chosen);
    CLI::App* help = app.add_subcommand(help_verb, "Show this text, or explain a verb");
    auto topic = std::make_shared<std::string>();
    help->add_option("verb", *topic, "The verb to explain");
    help->callback([&app, &chosen, topic, names = names_of(verbs)] {
        chosen.verb = help_verb;
        chosen.run = [&app, topic, names]() -> Status {
            if (!topic->empty() && !is_among(names, *topic))
                return unknown_verb(names, *topic);
            // app.help() would explain the verb `help`, because that was called.
            const CLI::App* about = topic->empty() ? &app : app.get_subcommand(*topic);
            const std::string name = topic->empty() ? "tessera" : "tessera " + *topic;
            const auto mode = CLI::AppFormatMode::Normal;
            std::fputs(about->get_formatter()->make_help(about, name, mode).c_str(), stdout);
            return {};
        };
    });
    app.add_subcommand(version_verb, "Show the versions of the tool and of the file format")
        ->callback([&chosen] {
            chosen.verb = version_verb;
            chosen.run = []() -> Status {
                std::printf("%s\n", version_text().c_str());
                return {};
            };
        });
}

} // namespace

std::span<const Verb> all_verbs() {
    static const Verb verbs[] = {{"bake", add_bake_command},
                                 {"fit", add_fit_command},
                                 {"encode", add_encode_command},
                                 {"decode", add_decode_command},
                                 {"compare", add_compare_command},
                                 {"info", add_info_command},
                                 {"validate", add_validate_command},
                                 {"convert", add_convert_command},
                                 {"sheet", add_sheet_command},
                                 {"shaders", add_shaders_command},
                                 {"render", add_render_command},
                                 {"bench", add_bench_command},
                                 {"rd", add_rd_command},
                                 {"view", add_view_command},
                                 {"serve", add_serve_command}};
    return verbs;
}

int run_tool(int argc, char** argv) {
    const std::string first = argc > 1 ? argv[1] : "";
    const std::vector<std::string> names = names_of(all_verbs());
    CLI::App app("Tessera: a codec for 4D textures (surface light fields), size UxVxSxT",
                 "tessera");
    app.allow_windows_style_options(false); // would take /folder/x.tess for an option
    app.set_version_flag("--version", version_text());
    app.require_subcommand(1);
    app.formatter(std::make_shared<HelpFormatter>());
    app.footer(std::string(main_help) + exit_codes_help);
    Invocation chosen;
    add_verbs(app, all_verbs(), chosen);
    if (!first.empty() && first[0] != '-' && !is_among(names, first))
        return report("", unknown_verb(names, first));
    if (first.empty())
        return report("", {ErrorCode::bad_argument, "a verb is needed (tessera help lists all)"});
    const std::string verb = is_among(names, first) ? first : "";
    const CLI::App* app_of_verb = verb.empty() ? nullptr : app.get_subcommand(verb);
    if (app_of_verb != nullptr)
        if (const Status status = check_words(*app_of_verb, {argv + 2, argv + argc}); !status.ok())
            return report(verb, status);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0)
            return app.exit(e); // --help, --version
        return report(verb, usage_error(app, app_of_verb, e));
    }
    const int code = report(chosen.verb, chosen.run());
    if (std::fflush(stdout) == 0 || code != 0)
        return code;
    return report(chosen.verb, {ErrorCode::io, "standard output: cannot be written"});
}

} // namespace tessera
