#include "format/io/unfinished.h"

#include "format/output_file.h"

#include <filesystem>
#include <map>

namespace tessera {

namespace {

struct Unfinished {
    std::recursive_mutex mutex;
    std::map<std::string, std::function<bool()>> ends; // by path
};

// Never destroyed: threads may still be at work when the process ends.
Unfinished& unfinished() {
    static Unfinished* const all = new Unfinished;
    return *all;
}

} // namespace

void note_unfinished(const std::string& path, std::function<bool()> end) {
    const std::lock_guard lock(unfinished().mutex);
    unfinished().ends[path] = std::move(end);
}

void forget_unfinished(const std::string& path) {
    const std::lock_guard lock(unfinished().mutex);
    unfinished().ends.erase(path);
}

std::unique_lock<std::recursive_mutex> hold_unfinished() {
    return std::unique_lock(unfinished().mutex);
}

std::vector<std::string> remove_unfinished_outputs() {
    unfinished().mutex.lock(); // for good: nothing new begins, nothing gets its name
    std::vector<std::string> kept;
    for (const auto& [path, end] : unfinished().ends) {
        std::error_code ignored;
        if (!end)
            std::filesystem::remove_all(path, ignored);
        else if (end())
            kept.push_back(path);
    }
    return kept;
}

} // namespace tessera
