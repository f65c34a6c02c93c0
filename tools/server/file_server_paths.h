// Maps request paths to files, and describes the version of a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// The file or folder below `root` that a decoded path such as "/a/b.tess" names. Nothing if it does
// not exist or is not served: "..", names that begin with a dot, links that lead out of `root`.
// `root` must be canonical.
std::optional<std::filesystem::path> find_served(const std::filesystem::path& root,
                                                 const std::string& path);

struct FileVersion {
    std::uint64_t size = 0;    // bytes
    std::int64_t changed = 0;  // seconds since 1970
    std::string etag;          // strong, with its quotes
    std::string last_modified; // an HTTP date
};
// Nothing if it is not a regular file.
std::optional<FileVersion> version_of(const std::filesystem::path& file);

// Whether a list such as `"a", W/"b"` or `*` contains the ETag. Weak ETags never match.
bool lists_etag(const std::string& list, const std::string& etag);

// Escapes text for a URL's path or query.
std::string percent_encoded(const std::string& text);

// A page that links to the .tess files and subfolders of `folder`, which was requested as `path`.
// With a viewer, the names lead to the viewer and the lengths to the files.
std::string list_folder(const std::filesystem::path& folder, const std::string& path,
                        bool has_viewer);

} // namespace tessera
