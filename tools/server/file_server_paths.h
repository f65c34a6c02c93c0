// Which file a request means, and which version of it is there.
#pragma once

#include <cstdint>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// The file or folder below `root` that a decoded path ("/a/b.tess") means. Nothing for what is not
// there or must not be seen: "..", names that begin with a point, links that lead out of `root`.
// `root` must be canonical.
std::optional<std::filesystem::path> find_served(const std::filesystem::path& root,
                                                 const std::string& path);

struct FileVersion {
    std::uint64_t size = 0; // bytes
    std::time_t changed = 0;
    std::string etag;          // strong, with its quotes
    std::string last_modified; // as in HTTP
};
// Nothing where there is no regular file.
std::optional<FileVersion> version_of(const std::filesystem::path& file);

// Whether a list such as `"a", W/"b"` or `*` holds the ETag. Weak ones never match.
bool lists_etag(const std::string& list, const std::string& etag);

// As a part of a URL's path or query.
std::string percent_encoded(const std::string& text);

// A page of links to the .tess files and folders in `folder`; `path` is how it was asked for. Where there is
// a viewer the names lead to it, and the lengths to the files.
std::string list_folder(const std::filesystem::path& folder, const std::string& path,
                        bool has_viewer);

} // namespace tessera
