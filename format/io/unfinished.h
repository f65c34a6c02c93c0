// Temporary files and folders that must be gone when the process ends, whatever ends it.
#pragma once

#include <functional>
#include <mutex>
#include <string>

namespace tessera {

// Thread-safe. After remove_unfinished_outputs() (format/output_file.h) they never return. `end` removes it
// in place of plain removal and returns whether it is worth keeping instead; called from any thread.
void note_unfinished(const std::string& path, std::function<bool()> end = {});
void forget_unfinished(const std::string& path);

// While held, the process does not end by remove_unfinished_outputs(): for steps that belong together.
std::unique_lock<std::recursive_mutex> hold_unfinished();

} // namespace tessera
