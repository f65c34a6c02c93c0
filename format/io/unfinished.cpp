#include "format/io/unfinished.h"

#include "format/io/system_calls.h"

#include <cerrno>
#include <map>

namespace tessera {
namespace {

constexpr int most_removals = 100;

struct Unfinished {
    std::recursive_mutex mutex;
    std::map<std::string, std::function<bool()>> ends; // by path
};

// Never destroyed, because threads may still use it when the process ends.
Unfinished& unfinished() {
    static Unfinished* const all = new Unfinished;
    return *all;
}

// Tries several times, because other threads may still add files to the folder.
void remove_in_use(const std::string& path) {
    int tries = 0;
    while (sys::remove_tree(path) < 0 && errno == ENOTEMPTY && ++tries < most_removals) {
    }
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
    unfinished().mutex.lock(); // never unlocked: no output can begin or be committed any more
    std::vector<std::string> kept;
    for (const auto& [path, end] : unfinished().ends) {
        if (!end)
            remove_in_use(path);
        else if (end())
            kept.push_back(path);
    }
    return kept;
}

} // namespace tessera
