#include "tools/gpu_renderer.h"

namespace tessera {

Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(const std::string& file,
                                                        const std::string& via, unsigned) {
    return Status(ErrorCode::unsupported,
                  file + ": this build cannot draw via '" + via + "'; 'cpu' always works");
}

} // namespace tessera
