#include "tools/http/open_bytes.h"

#include "tools/support/network_limits.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/standard_streams.h"
#ifdef TESSERA_HTTP
#include "tools/http/http_source.h"
#endif

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>

namespace tessera {
namespace {

Result<std::unique_ptr<ByteSource>> open_url(const std::string& url) {
#ifdef TESSERA_HTTP
    static const auto start = std::chrono::steady_clock::now(); // first request of the process
    const NetworkLimits& limits = network_limits();
    HttpOptions options;
    options.stall_bytes = limits.lowest_rate;
    if (limits.total_seconds > 0)
        options.deadline = start + std::chrono::duration_cast<std::chrono::milliseconds>(
                                       std::chrono::duration<double>(limits.total_seconds));
    if (!limits.quiet)
        options.waiting = show_waiting;
    if (const char* bundle = std::getenv("CURL_CA_BUNDLE")) // the variable that curl reads
        options.ca_file = bundle;
    TESSERA_TRY_ASSIGN(auto source, HttpSource::open(url, options));
    return std::unique_ptr<ByteSource>(std::move(source));
#else
    return Status(ErrorCode::unsupported, url + ": this program was built without HTTP");
#endif
}

Result<std::unique_ptr<ByteSource>> open_whole(const std::string& name) {
    const std::string scheme = scheme_of(name);
    if (name == standard_stream)
        return open_standard_input();
    if (scheme.empty())
        return open_file(name);
    if (scheme == "http" || scheme == "https")
        return open_url(name);
    return Status(ErrorCode::bad_argument, name + ": only http:// and https:// URLs can be read");
}

} // namespace

Result<std::unique_ptr<ByteSource>> open_bytes(const std::string& name) {
    const GlbName split = split_glb_name(name);
    TESSERA_TRY_ASSIGN(auto whole, open_whole(split.file));
    return unpack_glb(std::move(whole), split.texture);
}

Result<std::size_t> texture_count(const std::string& name) {
    if (split_glb_name(name).texture || !is_glb_name(name))
        return 1;
    TESSERA_TRY_ASSIGN(const auto whole, open_whole(name));
    if (!is_glb(*whole))
        return 1;
    TESSERA_TRY_ASSIGN(const auto payloads, find_glb_payloads(*whole));
    return payloads.size();
}

std::optional<Traffic> network_traffic([[maybe_unused]] const ByteSource& source) {
#ifdef TESSERA_HTTP
    if (const auto* http = dynamic_cast<const HttpSource*>(&whole_file(source))) {
        const HttpStatistics sum = http->statistics();
        return Traffic{sum.requests, sum.bytes};
    }
#endif
    return std::nullopt;
}

std::string transfer_text([[maybe_unused]] const ByteSource& source) {
#ifdef TESSERA_HTTP
    if (const auto* http = dynamic_cast<const HttpSource*>(&whole_file(source))) {
        const HttpStatistics sum = http->statistics();
        std::string text = ", " + std::to_string(sum.requests) +
                           (sum.requests == 1 ? " request, " : " requests, ") +
                           human_bytes(sum.bytes) + " received";
        if (sum.retries > 0)
            text += ", " + std::to_string(sum.retries) + (sum.retries == 1 ? " retry" : " retries");
        return text;
    }
#endif
    return "";
}

} // namespace tessera
