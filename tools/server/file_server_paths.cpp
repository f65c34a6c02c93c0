#include "tools/server/file_server_paths.h"

#include "format/output_file.h"
#include "tools/support/html_text.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <sys/stat.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;

std::string http_date(std::time_t time) {
    static const char* const days[] = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
    static const char* const months[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                         "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    std::tm t = {};
    if (gmtime_r(&time, &t) == nullptr)
        return "";
    char text[80];
    std::snprintf(text, sizeof text, "%s, %02d %s %04d %02d:%02d:%02d GMT", days[t.tm_wday],
                  t.tm_mday, months[t.tm_mon], t.tm_year + 1900, t.tm_hour, t.tm_min, t.tm_sec);
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
        if (name.front() == '.' || name.find('\0') != name.npos)
            return std::nullopt;
        wanted /= to_path(name);
    }
    std::error_code error;
    const fs::path real = fs::canonical(wanted, error);
    if (error || !is_below(real, root))
        return std::nullopt;
    return real;
}

std::optional<FileVersion> version_of(const fs::path& file) {
    struct stat info = {};
    if (::stat(file.c_str(), &info) != 0 || !S_ISREG(info.st_mode))
        return std::nullopt;
    FileVersion version;
    version.size = static_cast<std::uint64_t>(info.st_size);
    version.changed = info.st_mtim.tv_sec;
    char text[80];
    std::snprintf(text, sizeof text, "\"%llx-%llx-%lx\"",
                  static_cast<unsigned long long>(info.st_size),
                  static_cast<unsigned long long>(info.st_mtim.tv_sec),
                  static_cast<unsigned long>(info.st_mtim.tv_nsec));
    version.etag = text;
    version.last_modified = http_date(info.st_mtim.tv_sec);
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
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        const bool is_folder = entry.is_directory(ignored);
        if (name.front() == '.' || (!is_folder && !name.ends_with(".tess")))
            continue;
        const std::string slash = is_folder ? "/" : "", link = percent_encoded(name) + slash;
        const auto version = version_of(entry.path());
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
