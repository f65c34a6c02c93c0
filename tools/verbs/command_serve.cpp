#include "tools/verbs/command.h"
#ifdef TESSERA_HTTP
#include "tools/page/viewer_server.h"
#endif

#include <cstdio>
#include <mutex>

namespace tessera {
namespace {

struct ServeCommand {
    std::string folder, host = "127.0.0.1";
    int port = 8000;
    bool quiet = false;
};

#ifdef TESSERA_HTTP

// Flushes each line, because people and programs read them while the server runs.
void print_request(const ServedRequest& r) {
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    std::printf("%s %s %s%s%s %d, %llu bytes\n", r.client.c_str(), r.method.c_str(), r.path.c_str(),
                r.range.empty() ? "" : " ", r.range.c_str(), r.status,
                static_cast<unsigned long long>(r.bytes));
    std::fflush(stdout);
}

Status run(const ServeCommand& a) {
    FileServerOptions options = folder_with_viewer(a.folder);
    options.host = a.host;
    options.port = a.port;
    if (!a.quiet)
        options.log = print_request;
    TESSERA_TRY_ASSIGN(const auto server, FileServer::start(options));
    std::printf("%s\n", server->url().c_str());
    std::fflush(stdout);
    serve_until_interrupted();
}

#else

Status run(const ServeCommand&) {
    return {ErrorCode::unsupported, "this program was built without HTTP"};
}

#endif

} // namespace

void add_serve_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, ServeCommand& a) {
        c.add_option("folder", a.folder, "The folder with .tess files")->required();
        c.add_option("--port", a.port, "Port to listen on; 0 picks a free one")
            ->check(CLI::Range(0, 65535))
            ->capture_default_str();
        c.add_option("--host", a.host,
                     "Address to listen at; 0.0.0.0 means all addresses of this machine")
            ->capture_default_str();
        c.add_flag("--quiet,-q", a.quiet, "Print the URL only, no line per request");
    };
    add_verb<ServeCommand>(
        app, chosen, "serve", "Serve a folder over HTTP until Ctrl-C, with the viewer of `view`",
        "In a browser the URL shows a list of the .tess files; their names open the viewer. The "
        "program prints its URL, then one line per request: client, method, path, range, status, "
        "bytes of the body.\n\n"
        "The server speaks plain HTTP without passwords. It is for your own machine or a network "
        "that you trust: it serves 64 connections at a time, and slow clients can occupy them all."
        " A public site belongs behind a real web server; any that answers byte ranges can also "
        "serve .tess files by itself.\n\n"
        "Examples:\n"
        "  tessera serve textures/\n"
        "  tessera serve textures/ --port 0 --quiet\n"
        "  tessera info http://127.0.0.1:8000/scene.tess",
        declare, run);
}

} // namespace tessera
