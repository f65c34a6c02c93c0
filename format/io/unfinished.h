// A list of the temporary files and folders that must be removed before the process ends.
#pragma once

#include <functional>
#include <mutex>
#include <string>

namespace tessera {

// Add a path to the list, and remove it again. remove_unfinished_outputs() (format/output_file.h)
// removes the file or folder, or calls `end` instead, on any thread; `end` returns whether it kept
// the folder. Thread-safe. After remove_unfinished_outputs() these functions never return.
void note_unfinished(const std::string& path, std::function<bool()> end = {});
void forget_unfinished(const std::string& path);

// While the lock is held, remove_unfinished_outputs() waits. It protects steps that belong
// together.
std::unique_lock<std::recursive_mutex> hold_unfinished();

} // namespace tessera
