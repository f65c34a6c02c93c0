#include "tools/lab/rd/rivals.h"

#include "format/byte_source.h"
#include "format/output_file.h"
#include "format/work.h"
#include "tools/support/suggestions.h"

#include <cctype>
#include <filesystem>

namespace tessera {
namespace {

constexpr double version_timeout = 10; // seconds

// Returns the number with a decimal point that begins at `text[i]`, or an empty string.
std::string number_at(const std::string& text, std::size_t i) {
    const auto digit = [&](std::size_t at) {
        return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at]));
    };
    if (i > 0 && (digit(i - 1) || text[i - 1] == '.'))
        return "";
    std::size_t end = i, points = 0;
    while (digit(end) || (end < text.size() && text[end] == '.' && digit(end + 1)))
        points += text[end++] == '.';
    return points > 0 ? text.substr(i, end - i) : "";
}

// Finds "2.5.0" in a tool's output: tools print "version 2.5.0", "v2.5.0" or the bare number.
std::string version_in(const std::string& text) {
    for (const std::string before : {"ersion ", "ersion: ", " v", ""})
        for (std::size_t at = text.find(before); at < text.size(); at = text.find(before, at + 1))
            if (const std::string number = number_at(text, at + before.size()); !number.empty())
                return number;
    return "of unknown version";
}

std::string version_of(const Rival& rival) {
    if (rival.tools.empty())
        return "built in";
    std::vector<std::string> argv = {rival.tools.front()};
    argv.insert(argv.end(), rival.version_arguments.begin(), rival.version_arguments.end());
    const auto run = run_tool(argv, version_timeout);
    return rival.tools.front() + " " +
           (run.ok() ? version_in(" " + run->said) : "of unknown version");
}

std::string missing_tools(const Rival& rival) {
    std::string names;
    for (const std::string& tool : rival.tools)
        if (!find_tool(tool))
            names += (names.empty() ? "" : ", ") + tool;
    return names;
}

} // namespace

std::vector<Rival> all_rivals() {
    std::vector<Rival> all;
    for (std::vector<Rival> family : {video_rivals(), picture_rivals(), array_rivals()})
        for (Rival& rival : family)
            all.push_back(std::move(rival));
    return all;
}

Result<std::vector<Rival>> rivals_named(const std::string& list) {
    std::vector<Rival> chosen, all = all_rivals();
    if (list == "none")
        return chosen;
    if (list == "all" || list == "quick") {
        for (Rival& rival : all)
            if (list == "all" ? rival.usual : rival.quick)
                chosen.push_back(std::move(rival));
        return chosen;
    }
    std::string rest = list;
    while (!rest.empty()) {
        const std::size_t comma = rest.find(',');
        const std::string id = rest.substr(0, comma);
        rest = comma == std::string::npos ? "" : rest.substr(comma + 1);
        std::string known;
        std::vector<std::string> words{"all", "none"};
        const std::size_t before = chosen.size();
        for (const Rival& rival : all) {
            known += (known.empty() ? "" : ", ") + rival.id;
            words.push_back(rival.id);
            if (rival.id == id)
                chosen.push_back(rival);
        }
        if (chosen.size() == before)
            return Status(ErrorCode::bad_argument, "--rivals: '" + id +
                                                       "' is not one of all, none, " + known +
                                                       did_you_mean(id, words));
    }
    return chosen;
}

RivalChoice choose_rivals(const std::vector<Rival>& wanted, const TextureDesc& desc) {
    RivalChoice choice;
    for (const Rival& rival : wanted) {
        const std::string missing = missing_tools(rival);
        const std::string unfit = rival.not_applicable ? rival.not_applicable(desc) : "";
        if (!unfit.empty())
            choice.absent.push_back({rival.id, "not applicable: " + unfit});
        else if (!missing.empty())
            choice.absent.push_back(
                {rival.id, "not installed: " + missing + " (Debian package " + rival.package +
                               "; tools/lab/scripts/install-rivals.sh installs it)"});
        else
            choice.present.push_back({rival.id, rival.layout, version_of(rival), rival.settings,
                                      rival.coarser, rival.finer, rival.in_plot, rival.run});
    }
    return choice;
}

std::string value_of(const std::string& setting) {
    return setting.substr(setting.find(' ') + 1);
}

std::string threads_text(unsigned threads) {
    return std::to_string(thread_count(threads));
}

TickFunction ticker(const CodingJob& job, const char* stage) {
    return [&job, stage] {
        if (job.progress)
            job.progress(stage, 0, 1);
    };
}

Result<double> seconds_of_tool(const std::vector<std::string>& argv, double timeout,
                               const TickFunction& tick) {
    TESSERA_TRY_ASSIGN(const auto run, run_tool_well(argv, timeout, tick));
    return run.seconds;
}

std::string needs_rgb8(const TextureDesc& desc) {
    if (sample_bytes(desc.type) != 1)
        return "it takes 8-bit samples, but the texture has 16-bit floats";
    return desc.channels == 3
               ? ""
               : "it takes RGB, but the texture has " + std::to_string(desc.channels) + " channels";
}

Result<std::uint64_t> bytes_of_file(const std::string& path) {
    std::error_code error;
    const std::uint64_t bytes = std::filesystem::file_size(to_path(path), error);
    if (error)
        return Status(ErrorCode::runtime, to_path(path).filename().string() + ": was not written");
    return bytes;
}

Result<std::vector<std::byte>> bytes_in_file(const std::string& path) {
    TESSERA_TRY_ASSIGN(const auto file, open_file(path));
    std::vector<std::byte> bytes(file->size());
    TESSERA_TRY(file->read(0, bytes));
    return bytes;
}

} // namespace tessera
