// What a command did differently from what its input states: counted by kind, and listed at the end.
#pragma once

#include "format/status.h"
#include "tools/support/json_text.h"

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace tessera {

// Thread-safe.
class Warnings {
public:
    // If `strict`, each warning is an error.
    explicit Warnings(bool strict) : strict_(strict) {}

    // `kind` says what happened, "the gamma 1 is ignored"; `place` is the file, "" if there is only
    // one. Errors: unsupported, if strict.
    Status add(const std::string& kind, const std::string& place, std::uint64_t count = 1);

    // One line a kind to standard error: "tessera encode: warning: KIND (3 times, first in PLACE)".
    void print(const char* verb) const;
    // A list of {"warning", "count", "first"}, in the order of the lines.
    Json json() const;

private:
    struct Cases {
        std::uint64_t count = 0;
        std::string first; // place, by name
    };
    bool strict_;
    mutable std::mutex mutex_;
    std::map<std::string, Cases> kinds_;
};

} // namespace tessera
