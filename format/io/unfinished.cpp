#include "format/io/unfinished.h"

#include "format/output_file.h"

#include <filesystem>
#include <set>

namespace tessera {

namespace {

struct Unfinished {
    std::recursive_mutex mutex;
    std::set<std::string> paths;
};

// Never destroyed: threads may still be at work when the process ends.
Unfinished& unfinished() {
    static Unfinished* const all = new Unfinished;
    return *all;
}

} // namespace

void note_unfinished(const std::string& path) {
    const std::lock_guard lock(unfinished().mutex);
    unfinished().paths.insert(path);
}

void forget_unfinished(const std::string& path) {
    const std::lock_guard lock(unfinished().mutex);
    unfinished().paths.erase(path);
}

std::unique_lock<std::recursive_mutex> hold_unfinished() {
    return std::unique_lock(unfinished().mutex);
}

void remove_unfinished_outputs() {
    unfinished().mutex.lock(); // for good: nothing new begins, nothing gets its name
    std::error_code ignored;
    for (const std::string& path : unfinished().paths)
        std::filesystem::remove_all(path, ignored);
}

} // namespace tessera
