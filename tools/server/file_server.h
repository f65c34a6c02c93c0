// Serves the files of a folder over HTTP, in parts: what `tessera serve` is.
#pragma once

#include "format/status.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tessera {

// One answered request. Text that came from outside holds no control characters.
struct ServedRequest {
    std::string client;              // address
    std::string method, path, range; // range: as asked for, "" without
    int status = 0;
    std::uint64_t bytes = 0; // of the body
};

struct FileServerOptions {
    std::string folder;
    // A name in the folder: nothing else of it is served, and to no page of another host; empty: all is.
    std::string only;
    std::string host = "127.0.0.1";
    int port = 0; // 0: one that is free
    // A page of HTML that shows NAME.tess of its folder, asked for as ?f=NAME.tess; empty: there is none.
    std::string viewer;
    // What that page asks for as NAME.tess?view: what the file's decoder in the browser does not tell.
    std::function<Result<std::vector<std::byte>>(const std::string& path)> view_data;
    // Called from several threads, after each answer.
    std::function<void(const ServedRequest&)> log;
};

// GET and HEAD of regular files below the folder, with one or several byte ranges (at most 64), strong
// ETags made of size and time of change, Last-Modified, If-Match, If-None-Match, If-Range and
// If-Unmodified-Since; a folder shows its .tess files and folders, with a page that shows the former. Pages
// of other hosts may read all this (Access-Control-Allow-Origin), for which OPTIONS is answered. Names that begin with a point, and
// links that lead out of the folder, are not there. Files are streamed, whatever their size.
//
// Peers that drip, idle or never end cost little: a request's head has 8 KiB and 10 s, an idle connection
// 5 s, an answer is taken at 4 KiB/s in each 10 s (half a second where others wait), bodies are not read; of 2,000
// connections, or what the system's limit of open files allows, the one that waits longest makes room.
//
// Plain HTTP without passwords: for one's own machine or a network that one trusts.
class FileServer {
public:
    // Listens, and answers on threads of its own. Errors: io (no such folder, or the address cannot
    // be had).
    static Result<std::unique_ptr<FileServer>> start(const FileServerOptions& options);
    // Ends at once; connections are broken off.
    ~FileServer();

    int port() const;
    std::string url() const; // of the folder, with a slash at its end

private:
    class Impl;
    explicit FileServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

} // namespace tessera
