#include "tools/page/viewer_server.h"

#include "format/byte_source.h"
#include "tools/page/page.h"
#include "tools/page/view_data.h"

namespace tessera {
namespace {

Result<std::vector<std::byte>> view_data_of(const std::string& path) {
    TESSERA_TRY_ASSIGN(const auto source, open_file(path));
    TESSERA_TRY_ASSIGN(const auto container, ContainerReader::open(*source));
    return make_view_data(container);
}

} // namespace

FileServerOptions folder_with_viewer(const std::string& folder) {
    FileServerOptions options;
    options.folder = folder;
    if (auto page = make_server_page(); page.ok()) {
        options.viewer = std::move(*page);
        options.view_data = view_data_of;
    }
    return options;
}

} // namespace tessera
