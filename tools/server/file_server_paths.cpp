#include "tools/server/file_server_paths.h"

#include "format/output_file.h"
#include "tools/support/html_text.h"
#include "tools/support/system.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdio>

namespace tessera {
namespace {

namespace fs = std::filesystem;

std::string http_date(std::int64_t time) {
    static const char* const days[] = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
    static const char* const months[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                         "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    namespace ch = std::chrono;
    const ch::sys_seconds at{ch::seconds(time)};
    const auto midnight = ch::floor<ch::days>(at);
    const ch::year_month_day date(midnight);
    if (!date.ok())
        return "";
    const ch::hh_mm_ss clock(at - midnight);
    char text[80];
    std::snprintf(text, sizeof text, "%s, %02u %s %04d %02d:%02d:%02d GMT",
                  days[ch::weekday(midnight).c_encoding()], static_cast<unsigned>(date.day()),
                  months[static_cast<unsigned>(date.month()) - 1], static_cast<int>(date.year()),
                  static_cast<int>(clock.hours().count()),
                  static_cast<int>(clock.minutes().count()),
                  static_cast<int>(clock.seconds().count()));
    return text;
}

bool is_below(const fs::path& path, const fs::path& root) {
    const auto [at, _] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
    return at == root.end();
}

} // namespace

std::string percent_encoded(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte) || c == '-' || c == '_' || c == '.' || c == '~') {
            safe += c;
            continue;
        }
        char code[4];
        std::snprintf(code, sizeof code, "%%%02X", byte);
        safe += code;
    }
    return safe;
}

std::optional<fs::path> find_served(const fs::path& root, const std::string& path) {
    fs::path wanted = root;
    for (std::size_t begin = 0; begin < path.size();) {
        const std::size_t end = std::min(path.find('/', begin), path.size());
        const std::string name = path.substr(begin, end - begin);
        begin = end + 1;
        if (name.empty())
            continue;
        // On Windows a name may have steps, a drive or a server in it.
        const fs::path step = to_path(name);
        if (name.front() == '.' || name.find('\0') != name.npos || step != step.filename())
            return std::nullopt;
        wanted /= step;
    }
    std::error_code error;
    const fs::path real = fs::canonical(wanted, error);
    if (error || !is_below(real, root))
        return std::nullopt;
    return real;
}

std::optional<FileVersion> version_of(const fs::path& file) {
    const auto stamp = stamp_of(file);
    if (!stamp)
        return std::nullopt;
    FileVersion version;
    version.size = stamp->size;
    version.changed = stamp->seconds;
    char text[80];
    std::snprintf(text, sizeof text, "\"%llx-%llx-%llx\"",
                  static_cast<unsigned long long>(stamp->size),
                  static_cast<unsigned long long>(stamp->seconds),
                  static_cast<unsigned long long>(stamp->nanoseconds));
    version.etag = text;
    version.last_modified = http_date(stamp->seconds);
    return version;
}

bool lists_etag(const std::string& list, const std::string& etag) {
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        std::string one = list.substr(begin, end - begin);
        std::erase_if(one, [](char c) { return c == ' ' || c == '\t'; });
        if (one == "*" || one == etag)
            return true;
        begin = end + 1;
    }
    return false;
}

std::string list_folder(const fs::path& folder, const std::string& path, bool has_viewer) {
    std::vector<std::string> lines;
    std::error_code ignored;
    for (const std::string& name : names_in(folder.string(), ignored)) {
        const fs::path entry = folder / to_path(name);
        const bool is_folder = fs::is_directory(entry, ignored);
        if (name.front() == '.' || (!is_folder && !name.ends_with(".tess")))
            continue;
        const std::string slash = is_folder ? "/" : "", link = percent_encoded(name) + slash;
        const auto version = version_of(entry);
        const std::string length = version ? std::to_string(version->size) + " bytes" : "";
        std::string line =
            "<li><a href=\"" + link + "\">" + html_text(name) + slash + "</a> " + length;
        if (has_viewer && version)
            line = "<li><a href=\"?f=" + link + "\">" + html_text(name) + "</a> <a href=\"" + link +
                   "\">" + length + "</a>";
        lines.push_back(line + "</li>\n");
    }
    std::ranges::sort(lines);
    std::string page =
        "<!DOCTYPE html>\n<html><head><meta charset=\"utf-8\"><title>Tessera: " + html_text(path) +
        "</title></head><body>\n<h1>" + html_text(path) + "</h1>\n<ul>\n";
    for (const std::string& line : lines)
        page += line;
    return page + "</ul>\n</body></html>\n";
}

} // namespace tessera
