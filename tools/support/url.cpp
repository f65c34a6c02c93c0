#include "tools/support/url.h"

#include <algorithm>
#include <cctype>

namespace tessera {

std::string scheme_of(const std::string& name) {
    std::string scheme = name.substr(0, std::min(name.find("://"), name.size()));
    if (scheme.size() == name.size() || scheme.empty())
        return "";
    for (char& c : scheme) {
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '+' && c != '-' && c != '.')
            return "";
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return scheme;
}

bool is_url(const std::string& name) {
    return !scheme_of(name).empty();
}

std::string without_query(const std::string& name) {
    return is_url(name) ? name.substr(0, name.find_first_of("?#")) : name;
}

} // namespace tessera
