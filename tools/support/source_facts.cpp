#include "tools/support/source_facts.h"

#include "format/output_file.h"
#include "tools/support/checksum.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// Seconds and nanoseconds since 1970; "" if there is no such file.
std::string time_of(const fs::path& path) {
    using std::chrono::duration_cast, std::chrono::seconds, std::chrono::nanoseconds;
    std::error_code error;
    const auto changed = fs::last_write_time(path, error);
    if (error)
        return "";
    const auto since = std::chrono::file_clock::to_sys(changed).time_since_epoch();
    const auto whole = duration_cast<seconds>(since);
    return std::to_string(whole.count()) + "." +
           std::to_string(duration_cast<nanoseconds>(since - whole).count());
}

std::string length_of(const fs::path& path) {
    std::error_code error;
    const std::uintmax_t length = fs::file_size(path, error);
    return error ? "0" : std::to_string(length);
}

} // namespace

std::vector<std::pair<std::string, std::string>> source_facts(const std::string& name,
                                                              const std::string& what) {
    const fs::path path = to_path(name);
    std::error_code error;
    if (const std::string time = time_of(path); time.empty())
        return {};
    else if (!fs::is_directory(path, error))
        return {{"length of the " + what, length_of(path)}, {"time of the " + what, time}};
    std::map<std::string, std::string> files; // in order of their names
    for (const std::string& file : names_in(name, error))
        if (const std::string time = time_of(path / to_path(file)); !time.empty())
            files[file] = length_of(path / to_path(file)) + " " + time;
    std::uint32_t crc = 0;
    for (const auto& [name, facts] : files) {
        const std::string line = name + " " + facts + "\n";
        crc = checksum(std::as_bytes(std::span(line)), crc);
    }
    return {{"number of " + what + " files", std::to_string(files.size())},
            {"checksum of " + what + " lengths and times", std::to_string(crc)}};
}

} // namespace tessera
