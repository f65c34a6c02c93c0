#include "tools/page/viewer_server.h"

#include "format/byte_source.h"
#include "tools/http/glb_payload.h"
#include "tools/page/page.h"
#include "tools/page/view_data.h"
#include "tools/server/file_server_paths.h"
#include "tools/support/interrupt.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

namespace tessera {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t most_kept_view_data = std::size_t{64} << 20; // bytes

Result<Bytes> view_data_of(const std::string& path) {
    const GlbName split = split_glb_name(path);
    TESSERA_TRY_ASSIGN(auto file, open_file(split.file));
    TESSERA_TRY_ASSIGN(const auto source, unpack_glb(std::move(file), split.texture));
    TESSERA_TRY_ASSIGN(const auto container, ContainerReader::open(*source));
    return make_view_data(*source, container);
}

// Caches the view data of the latest files. A large mesh takes much time and memory, so only one
// file is processed at a time, once for all who request it. Thread-safe.
class KeptViewData {
public:
    Result<Bytes> of(const std::string& path) {
        const auto version = version_of(split_glb_name(path).file);
        const std::string key = (version ? version->etag : "") + path;
        const std::lock_guard lock(mutex_);
        for (const auto& [name, data] : kept_)
            if (name == key)
                return data;
        TESSERA_TRY_ASSIGN(Bytes made, view_data_of(path));
        kept_.emplace_back(key, made);
        bytes_ += made.size();
        while (bytes_ > most_kept_view_data) {
            bytes_ -= kept_.front().second.size();
            kept_.pop_front();
        }
        return made;
    }

private:
    std::mutex mutex_;
    std::deque<std::pair<std::string, Bytes>> kept_;
    std::size_t bytes_ = 0; // of everything in kept_
};

} // namespace

FileServerOptions folder_with_viewer(const std::string& folder) {
    FileServerOptions options;
    options.folder = folder;
    if (auto page = make_server_page(); page.ok()) {
        options.viewer = std::move(*page);
        options.viewer_part = viewer_part;
        options.view_data = [kept = std::make_shared<KeptViewData>()](const std::string& file) {
            return kept->of(file);
        };
    }
    return options;
}

void serve_until_interrupted() {
    while (interrupted_by() == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::fflush(stdout);
    std::_Exit(0);
}

} // namespace tessera
