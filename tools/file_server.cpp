#include "tools/file_server.h"

#include "format/byte_source.h"
#include "tools/file_server_paths.h"
#include "tools/http_response.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <curl/curl.h>
#include <filesystem>
#include <httplib.h>
#include <thread>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// A connection that is kept open holds a thread.
constexpr std::size_t threads = 64;
constexpr std::size_t requests_per_connection = 1'000'000;
constexpr std::time_t idle_seconds = 2; // then a connection is closed; stopping waits for it
constexpr std::size_t max_ranges = 64;
constexpr std::size_t piece_bytes = 256 << 10; // streamed at a time

std::string printable(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 32 || c == 127)
            c = '?';
    return text;
}

// The ranges as bytes of a file of `size`, cut to it (RFC 9110, 14.1.2); those that lie outside are
// left out.
httplib::Ranges satisfiable(const httplib::Ranges& ranges, std::uint64_t size) {
    httplib::Ranges kept;
    const auto length = static_cast<ssize_t>(size);
    for (auto [first, last] : ranges) {
        if (first < 0 && last <= 0) // "-" or "-0"
            continue;
        if (first < 0) { // the last so many bytes
            first = std::max<ssize_t>(0, length - last);
            last = length - 1;
        }
        if (last < 0 || last >= length)
            last = length - 1;
        if (first <= last)
            kept.emplace_back(first, last);
    }
    return kept;
}

// The status that the request's conditions ask for instead of the file; 0: none.
int refused_by_conditions(const httplib::Request& request, const FileVersion& version) {
    if (request.has_header("If-Match")) {
        if (!lists_etag(request.get_header_value("If-Match"), version.etag))
            return 412;
    } else if (request.has_header("If-Unmodified-Since")) {
        const std::time_t since =
            curl_getdate(request.get_header_value("If-Unmodified-Since").c_str(), nullptr);
        if (since >= 0 && version.changed > since)
            return 412;
    }
    if (request.has_header("If-None-Match") &&
        lists_etag(request.get_header_value("If-None-Match"), version.etag))
        return 304;
    return 0;
}

bool is_of_version(const std::string& if_range, const FileVersion& version) {
    return if_range.empty() || if_range == version.etag || if_range == version.last_modified;
}

// Answers with the file. A file that shrinks meanwhile breaks the connection off.
void send_file(const std::shared_ptr<ByteSource>& file, httplib::Response& response) {
    if (file->size() == 0) {
        response.set_content("", "application/octet-stream");
        return;
    }
    response.set_content_provider(
        static_cast<std::size_t>(file->size()), "application/octet-stream",
        [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
            std::vector<std::byte> piece(std::min(length, piece_bytes));
            return file->read(offset, piece).ok() &&
                   sink.write(reinterpret_cast<const char*>(piece.data()), piece.size());
        });
}

// `request` is the library's own, and not const there: this version of it (0.11) applies the ranges
// without cutting them to the file, so it is given better ones.
void answer_file(const fs::path& path, httplib::Request& request, httplib::Response& response) {
    const auto version = version_of(path);
    auto opened = open_file(path.string());
    if (!version || !opened.ok() || (*opened)->size() != version->size) {
        request.ranges.clear();
        response.status = version && opened.ok() ? 503 : 404; // 503: it is being written
        return;
    }
    response.set_header("Accept-Ranges", "bytes");
    response.set_header("ETag", version->etag);
    response.set_header("Last-Modified", version->last_modified);
    if (const int status = refused_by_conditions(request, *version); status != 0) {
        request.ranges.clear();
        response.status = status;
        return;
    }
    if (request.method != "GET" || !is_of_version(request.get_header_value("If-Range"), *version))
        request.ranges.clear();
    if (!request.ranges.empty()) {
        request.ranges = satisfiable(request.ranges, version->size);
        if (request.ranges.empty() || request.ranges.size() > max_ranges) {
            request.ranges.clear();
            response.set_header("Content-Range", "bytes */" + std::to_string(version->size));
            response.status = 416;
            return;
        }
    }
    send_file(std::move(*opened), response);
}

void answer(const fs::path& root, httplib::Request& request, httplib::Response& response) {
    const auto path = find_served(root, request.path);
    if (path && !fs::is_directory(*path))
        return answer_file(*path, request, response);
    request.ranges.clear();
    if (!path) {
        response.status = 404;
        response.set_content("There is no such file.\n", "text/plain");
    } else if (!request.path.ends_with('/')) {
        response.set_redirect(fs::path(request.path).filename().string() + "/");
    } else {
        response.set_content(list_folder(*path, request.path), "text/html; charset=utf-8");
    }
}

} // namespace

class FileServer::Impl {
public:
    Impl(fs::path root, const FileServerOptions& options) : root_(std::move(root)) {
        server_.new_task_queue = [] { return new httplib::ThreadPool(threads); };
        server_.set_keep_alive_max_count(requests_per_connection);
        server_.set_keep_alive_timeout(idle_seconds);
        server_.set_tcp_nodelay(true);
        // Not the library's SO_REUSEPORT, with which two servers share a port and nobody is told.
        server_.set_socket_options([](socket_t socket) {
            const int yes = 1;
            setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        });
        server_.set_pre_routing_handler(
            [this](const httplib::Request& request, httplib::Response& response) {
                if (request.method != "GET" && request.method != "HEAD")
                    return httplib::Server::HandlerResponse::Unhandled;
                answer(root_, const_cast<httplib::Request&>(request), response);
                return httplib::Server::HandlerResponse::Handled;
            });
        if (options.log)
            server_.set_logger([log = options.log](const httplib::Request& request,
                                                   const httplib::Response& response) {
                const bool has_body =
                    request.method != "HEAD" &&
                    (response.content_provider_success_ || !response.body.empty());
                const auto length = parse_decimal(response.get_header_value("Content-Length"));
                log({request.remote_addr, printable(request.method), printable(request.path),
                     printable(request.get_header_value("Range")), response.status,
                     has_body ? length.value_or(0) : 0});
            });
    }

    ~Impl() {
        if (!thread_.joinable())
            return;
        server_.stop();
        thread_.join();
    }

    Status listen(const FileServerOptions& options) {
        port_ = options.port == 0 ? server_.bind_to_any_port(options.host)
                : server_.bind_to_port(options.host, options.port) ? options.port
                                                                   : -1;
        const bool is_v6 = options.host.find(':') != std::string::npos;
        const std::string host = is_v6 ? "[" + options.host + "]" : options.host;
        if (port_ <= 0)
            return {ErrorCode::io, host + ":" + std::to_string(options.port) +
                                       ": cannot listen there: the port is taken, or the address "
                                       "is not this machine's"};
        url_ = "http://" + host + ":" + std::to_string(port_) + "/";
        thread_ = std::thread([this] {
            server_.listen_after_bind();
            ended_ = true;
        });
        while (!server_.is_running() && !ended_) // stop() has no effect before
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return {};
    }

    int port_ = 0;
    std::string url_;

private:
    const fs::path root_;
    httplib::Server server_;
    std::atomic<bool> ended_{false};
    std::thread thread_;
};

Result<std::unique_ptr<FileServer>> FileServer::start(const FileServerOptions& options) {
    std::error_code error;
    const fs::path root = fs::canonical(options.folder, error);
    if (error || !fs::is_directory(root))
        return Status(ErrorCode::io, options.folder + ": is no folder");
    auto impl = std::make_unique<Impl>(root, options);
    TESSERA_TRY(impl->listen(options));
    return std::unique_ptr<FileServer>(new FileServer(std::move(impl)));
}

FileServer::FileServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FileServer::~FileServer() = default;

int FileServer::port() const {
    return impl_->port_;
}

std::string FileServer::url() const {
    return impl_->url_;
}

} // namespace tessera
