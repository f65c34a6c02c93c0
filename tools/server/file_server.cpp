#include "tools/server/file_server.h"

#include "format/byte_source.h"
#include "format/output_file.h"
#include "tools/http/http_response.h"
#include "tools/server/file_server_paths.h"
#include "tools/server/file_server_ranges.h"
#include "tools/support/parse.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <curl/curl.h>
#include <filesystem>
#include <httplib.h>
#include <map>
#include <thread>
#include <utility>

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t connection_threads = 64; // connections served at a time; others wait
constexpr std::size_t requests_per_connection = 1000;
// Seconds until a connection ends: without a request, within a request that does not go on, and
// while the client does not accept the next bytes of an answer.
constexpr std::time_t idle_seconds = 1, read_seconds = 5, write_seconds = 5;
constexpr std::size_t max_ranges = 64;

// The status to send instead of the file because of the request's If-... fields; 0: send the file.
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

// Browsers insist on these types for pages, modules and pictures.
std::string type_of(const fs::path& file) {
    static const std::map<std::string, std::string> types = {{".html", "text/html; charset=utf-8"},
                                                             {".wasm", "application/wasm"},
                                                             {".js", "text/javascript"},
                                                             {".json", "application/json"},
                                                             {".png", "image/png"},
                                                             {".tess", "application/vnd.tessera"}};
    const auto found = types.find(file.extension().string());
    return found == types.end() ? "application/octet-stream" : found->second;
}

// Sends the parts, or the whole file if there are none. If the file shrinks meanwhile, the
// connection breaks off. cpp-httplib 0.11 does not clip ranges to the file and states a wrong
// length for several ranges. So this file implements them, and the library does not see them.
void send_file(std::shared_ptr<ByteSource> file, std::string type,
               const std::vector<FilePart>& parts, httplib::Response& response) {
    const std::uint64_t size = file->size();
    const auto body = std::make_shared<PartsBody>(std::move(file));
    if (parts.size() > 1) {
        const std::string boundary = "tessera-part-7c1d5b9e-53a2-4f0e-9d6b-8a1f0c3e2b47";
        body->add_multipart(parts, boundary);
        type = "multipart/byteranges; boundary=" + boundary;
    } else if (parts.size() == 1) {
        body->add_part(parts.front());
        response.set_header("Content-Range", "bytes " + std::to_string(parts.front().first) + "-" +
                                                 std::to_string(parts.front().last) + "/" +
                                                 std::to_string(size));
    } else if (size > 0) {
        body->add_part({0, size - 1});
    }
    response.status = parts.empty() ? 200 : 206;
    response.set_header("Content-Length", std::to_string(body->size()));
    response.set_content_provider(type, [body](std::size_t, httplib::DataSink& sink) {
        if (!body->at_end() && !body->send_some(sink.write))
            return false;
        if (body->at_end())
            sink.done();
        return true;
    });
}

void answer_file(const fs::path& path, const httplib::Request& request,
                 const httplib::Ranges& ranges, httplib::Response& response) {
    const auto version = version_of(path);
    auto opened = open_file(path.string());
    if (!version || !opened.ok() || (*opened)->size() != version->size) {
        response.status = version && opened.ok() ? 503 : 404; // 503: the file is being written
        return;
    }
    response.set_header("Accept-Ranges", "bytes");
    response.set_header("ETag", version->etag);
    response.set_header("Last-Modified", version->last_modified);
    if (const int status = refused_by_conditions(request, *version); status != 0) {
        response.status = status;
        return;
    }
    std::vector<FilePart> parts;
    const bool in_parts = request.method == "GET" && !ranges.empty() &&
                          is_of_version(request.get_header_value("If-Range"), *version);
    if (in_parts) {
        parts = parts_of({ranges.begin(), ranges.end()}, version->size);
        if (parts.empty() || parts.size() > max_ranges) {
            response.set_header("Content-Range", "bytes */" + std::to_string(version->size));
            response.status = 416;
            return;
        }
    }
    send_file(std::move(*opened), type_of(path), parts, response);
}

void answer_view_data(const FileServerOptions& options, const fs::path& path,
                      const std::string& texture, httplib::Response& response) {
    const auto data = options.view_data(path.string() + (texture.empty() ? "" : "#" + texture));
    response.status = data.ok() ? 200 : 404;
    if (data.ok())
        response.set_content(reinterpret_cast<const char*>(data->data()), data->size(),
                             "application/x-tessera-view");
    else
        response.set_content(data.status().message() + "\n", "text/plain");
}

void answer_viewer_part(const FileServerOptions& options, const std::string& name,
                        httplib::Response& response) {
    const auto part = options.viewer_part(name);
    response.status = part ? 200 : 404;
    if (!part)
        return response.set_content("The viewer has no such file.\n", "text/plain");
    if (part->is_gzip)
        response.set_header("Content-Encoding", "gzip");
    response.set_content(part->content, part->type);
}

// Like find_served(), but with `only` set it finds that file alone.
std::optional<fs::path> find_allowed(const FileServerOptions& options, const fs::path& root,
                                     const std::string& path) {
    if (options.only.empty())
        return find_served(root, path);
    if (path == "/" && !options.viewer.empty())
        return root;
    return path == "/" + options.only ? std::optional(root / options.only) : std::nullopt;
}

void answer(const FileServerOptions& options, const fs::path& root, const httplib::Request& request,
            const httplib::Ranges& ranges, httplib::Response& response) {
    const auto path = find_allowed(options, root, request.path);
    if (path && options.view_data && request.has_param("view") && version_of(*path))
        return answer_view_data(options, *path, request.get_param_value("view"), response);
    if (path && !fs::is_directory(*path))
        return answer_file(*path, request, ranges, response);
    if (path && options.viewer_part && request.has_param("viewer"))
        return answer_viewer_part(options, request.get_param_value("viewer"), response);
    if (!path) {
        response.status = 404;
        response.set_content("There is no such file.\n", "text/plain");
    } else if (!request.path.ends_with('/')) {
        response.set_redirect(percent_encoded(to_path(request.path).filename().string()) + "/");
    } else if (!options.viewer.empty() && (request.has_param("f") || !options.only.empty())) {
        response.set_content(options.viewer, "text/html; charset=utf-8");
    } else {
        response.set_content(list_folder(*path, request.path, !options.viewer.empty()),
                             "text/html; charset=utf-8");
    }
}

// Lets pages of other hosts read files in parts (CORS).
void allow_other_pages(httplib::Response& response) {
    response.set_header("Access-Control-Allow-Origin", "*");
    response.set_header("Access-Control-Expose-Headers",
                        "Accept-Ranges, Content-Range, ETag, Last-Modified");
}

void answer_options(httplib::Response& response) {
    response.status = 204;
    response.set_header("Access-Control-Allow-Methods", "GET, HEAD, OPTIONS");
    response.set_header("Access-Control-Allow-Headers", "Range, If-Range, If-Match, If-None-Match");
    response.set_header("Access-Control-Max-Age", "86400");
}

// Bodies of requests are not read. The library would parse a body as the next request. It ends the
// connection only if a content provider fails, so this one fails after the text.
void refuse_body(int status, httplib::Response& response) {
    static const std::string text = "Requests with a body are not accepted.\n";
    response.status = status;
    response.set_header("Connection", "close");
    response.set_header("Content-Length", std::to_string(text.size()));
    response.set_content_provider("text/plain", [](std::size_t, httplib::DataSink& sink) {
        sink.write(text.data(), text.size());
        return false;
    });
}

bool has_body(const httplib::Request& request) {
    return request.has_header("Transfer-Encoding") ||
           request.get_header_value<std::uint64_t>("Content-Length") > 0;
}

void route(const FileServerOptions& options, const fs::path& root, const httplib::Request& request,
           httplib::Response& response) {
    if (options.only.empty())
        allow_other_pages(response);
    const bool reads = request.method == "GET" || request.method == "HEAD";
    if (!reads)
        response.set_header("Allow", "GET, HEAD, OPTIONS");
    if (has_body(request))
        return refuse_body(reads ? 400 : 405, response);
    if (request.method == "OPTIONS")
        return answer_options(response);
    if (!reads) {
        response.status = 405;
        return;
    }
    // The library made the request, and not const; see send_file().
    const auto ranges = std::exchange(const_cast<httplib::Request&>(request).ranges, {});
    answer(options, root, request, ranges, response);
}

void log_request(const std::function<void(const ServedRequest&)>& log,
                 const httplib::Request& request, const httplib::Response& response) {
    const bool sends_body =
        request.method != "HEAD" && (response.content_provider_success_ || !response.body.empty());
    const auto length = parse_decimal(response.get_header_value("Content-Length"));
    log({request.remote_addr, printable(request.method), printable(request.path),
         printable(request.get_header_value("Range")), response.status,
         sends_body ? length.value_or(0) : 0});
}

} // namespace

class FileServer::Impl {
public:
    Impl(fs::path root, const FileServerOptions& options)
        : options_(options), root_(std::move(root)) {
        server_.new_task_queue = [] { return new httplib::ThreadPool(connection_threads); };
        server_.set_keep_alive_max_count(requests_per_connection);
        server_.set_keep_alive_timeout(idle_seconds);
        server_.set_read_timeout(read_seconds);
        server_.set_write_timeout(write_seconds);
        server_.set_payload_max_length(0);
        server_.set_tcp_nodelay(true);
        // The library's default, SO_REUSEPORT, lets two servers share a port without an error. On
        // Windows SO_REUSEADDR does so too.
        server_.set_socket_options([](socket_t socket) {
            const int yes = 1;
#ifdef SO_EXCLUSIVEADDRUSE
            const int option = SO_EXCLUSIVEADDRUSE;
#else
            const int option = SO_REUSEADDR;
#endif
            setsockopt(socket, SOL_SOCKET, option, reinterpret_cast<const char*>(&yes), sizeof yes);
        });
        server_.set_pre_routing_handler(
            [this](const httplib::Request& request, httplib::Response& response) {
                route(options_, root_, request, response);
                return httplib::Server::HandlerResponse::Handled;
            });
        if (options_.log)
            server_.set_logger(
                [this](const httplib::Request& request, const httplib::Response& response) {
                    log_request(options_.log, request, response);
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
        while (!server_.is_running() && !ended_) // stop() has no effect earlier
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return {};
    }

    int port_ = 0;
    std::string url_;

private:
    const FileServerOptions options_;
    const fs::path root_;
    httplib::Server server_;
    std::atomic<bool> ended_{false};
    std::thread thread_;
};

Result<std::unique_ptr<FileServer>> FileServer::start(const FileServerOptions& options) {
    std::error_code error;
    const fs::path root = fs::canonical(to_path(options.folder), error);
    if (error || !fs::is_directory(root))
        return Status(ErrorCode::io, options.folder + ": is not a folder");
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
