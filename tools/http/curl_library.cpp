#include "tools/http/curl_library.h"

#include <dlfcn.h>
#include <string>

namespace tessera {
namespace {

constexpr const char* curl_file = "libcurl.so.4"; // the binary interface that curl.h declares

struct LoadedCurl {
    CurlLibrary library{};
    Status status;
};

// Stays open for good: its threads and handlers may outlive whoever asked.
LoadedCurl open_curl() {
    LoadedCurl loaded;
    void* handle = ::dlopen(curl_file, RTLD_NOW | RTLD_LOCAL);
    const auto failed = [] {
        const char* why = ::dlerror();
        return Status(ErrorCode::unsupported,
                      std::string("HTTP needs libcurl, which cannot be used: ") +
                          (why != nullptr ? why : curl_file));
    };
    if (handle == nullptr) {
        loaded.status = failed();
        return loaded;
    }
    const auto find = [&](const char* name, auto& function) {
        function = reinterpret_cast<std::decay_t<decltype(function)>>(::dlsym(handle, name));
        if (function == nullptr && loaded.status.ok())
            loaded.status = failed();
    };
    CurlLibrary& c = loaded.library;
    find("curl_easy_cleanup", c.easy_cleanup);
    find("curl_easy_getinfo", c.easy_getinfo);
    find("curl_easy_init", c.easy_init);
    find("curl_easy_setopt", c.easy_setopt);
    find("curl_easy_strerror", c.easy_strerror);
    find("curl_free", c.free);
    find("curl_getdate", c.getdate);
    find("curl_global_init", c.global_init);
    find("curl_multi_add_handle", c.multi_add_handle);
    find("curl_multi_cleanup", c.multi_cleanup);
    find("curl_multi_info_read", c.multi_info_read);
    find("curl_multi_init", c.multi_init);
    find("curl_multi_perform", c.multi_perform);
    find("curl_multi_poll", c.multi_poll);
    find("curl_multi_remove_handle", c.multi_remove_handle);
    find("curl_multi_setopt", c.multi_setopt);
    find("curl_multi_wakeup", c.multi_wakeup);
    find("curl_slist_append", c.slist_append);
    find("curl_slist_free_all", c.slist_free_all);
    find("curl_url", c.url);
    find("curl_url_cleanup", c.url_cleanup);
    find("curl_url_get", c.url_get);
    find("curl_url_set", c.url_set);
    find("curl_url_strerror", c.url_strerror);
    if (loaded.status.ok() && c.global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK)
        loaded.status = {ErrorCode::runtime, "libcurl does not start"};
    return loaded;
}

const LoadedCurl& loaded_curl() {
    static const LoadedCurl loaded = open_curl();
    return loaded;
}

} // namespace

Status load_curl() {
    return loaded_curl().status;
}

const CurlLibrary& curl() {
    return loaded_curl().library;
}

} // namespace tessera
