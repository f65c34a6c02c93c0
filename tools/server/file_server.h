// The HTTP server of `tessera serve`: the files of a folder, whole or in parts.
#pragma once

#include "format/status.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// One answered request. Control characters in its text are replaced by spaces.
struct ServedRequest {
    std::string client;              // address
    std::string method, path, range; // range: the text of the field Range, may be empty
    int status = 0;
    std::uint64_t bytes = 0; // of the body
};

// A file that belongs to the viewer.
struct ViewerPart {
    std::string type; // MIME
    std::string content;
    bool is_gzip = false; // of `content`
};

struct FileServerOptions {
    std::string folder;
    // The name of the only file of the folder to serve, to pages of this host alone. Empty: serve
    // the whole folder, to pages of all hosts.
    std::string only;
    std::string host = "127.0.0.1";
    int port = 0; // 0: any free one
    // An HTML page that shows the file NAME.tess beside it if its URL ends in ?f=NAME.tess. Empty:
    // there is no viewer.
    std::string viewer;
    // Returns what that page requests as NAME.tess?view: what it needs besides the texels.
    std::function<Result<std::vector<std::byte>>(const std::string& path)> view_data;
    // Returns what that page requests as ?viewer=NAME beside it; nothing if there is no such file.
    std::function<std::optional<ViewerPart>(const std::string& name)> viewer_part;
    // Called after each answer, from several threads.
    std::function<void(const ServedRequest&)> log;
};

// Answers GET and HEAD of regular files below the folder, with up to 64 byte ranges a request,
// strong ETags made of size and modification time, Last-Modified, If-Match, If-None-Match, If-Range
// and If-Unmodified-Since. A folder's page lists its .tess files and subfolders. Pages of other
// hosts may read all of this (CORS, including OPTIONS). Names that begin with a dot, and links that
// lead out of the folder, are answered with 404. Files are streamed, whatever their size.
//
// cpp-httplib serves each connection on one of 64 threads; further connections wait. A connection
// ends after 1 s without a request, after 5 s in which a request does not go on or the client
// accepts no byte, and after 1,000 requests. So slow clients can occupy all threads. Request bodies
// are refused.
//
// The server speaks plain HTTP without passwords, for your own machine or a trusted network. A
// public site belongs behind a real web server.
class FileServer {
public:
    // Listens, and answers on threads of its own. Errors: io (no such folder, or it cannot listen
    // at the address).
    static Result<std::unique_ptr<FileServer>> start(const FileServerOptions& options);
    // Ends answers that are being sent and waits until their connections have ended, a few seconds.
    ~FileServer();

    int port() const;
    std::string url() const; // of the folder, ends in a slash

private:
    class Impl;
    explicit FileServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

} // namespace tessera
