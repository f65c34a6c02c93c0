#include "tools/support/source_facts.h"

#include "tools/support/checksum.h"

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>

namespace tessera {
namespace {

namespace fs = std::filesystem;

std::string time_of(const struct stat& info) {
    return std::to_string(info.st_mtim.tv_sec) + "." + std::to_string(info.st_mtim.tv_nsec);
}

} // namespace

std::vector<std::pair<std::string, std::string>> source_facts(const std::string& path,
                                                              const std::string& what) {
    struct stat info = {};
    if (::stat(path.c_str(), &info) != 0)
        return {};
    if (!S_ISDIR(info.st_mode))
        return {{"length of the " + what, std::to_string(info.st_size)},
                {"time of the " + what, time_of(info)}};
    std::map<std::string, std::string> files; // in order of their names
    std::error_code error;
    for (fs::directory_iterator i(path, error), end; !error && i != end; i.increment(error))
        if (::stat(i->path().c_str(), &info) == 0)
            files[i->path().filename().string()] =
                std::to_string(info.st_size) + " " + time_of(info);
    std::uint32_t crc = 0;
    for (const auto& [name, facts] : files) {
        const std::string line = name + " " + facts + "\n";
        crc = checksum(std::as_bytes(std::span(line)), crc);
    }
    return {{"number of " + what + " files", std::to_string(files.size())},
            {"checksum of " + what + " lengths and times", std::to_string(crc)}};
}

} // namespace tessera
