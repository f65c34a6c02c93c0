// Prints JSON to standard output. Bytes that are not UTF-8, as in some file names, are replaced.
#pragma once

#include <cstdio>
#include <nlohmann/json.hpp>

namespace tessera {

using Json = nlohmann::ordered_json;

inline void print_json(const Json& json) {
    const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace);
    std::printf("%s\n", text.c_str());
}

} // namespace tessera
