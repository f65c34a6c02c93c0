#include "tools/support/warnings.h"

#include <cstdio>

namespace tessera {

Status Warnings::add(const std::string& kind, const std::string& place, std::uint64_t count) {
    if (count == 0)
        return {};
    if (strict_)
        return {ErrorCode::unsupported, (place.empty() ? "" : place + ": ") + kind + " (--strict)"};
    const std::lock_guard lock(mutex_);
    const auto [entry, is_new] = kinds_.try_emplace(kind);
    Cases& cases = entry->second;
    cases.count += count;
    if (is_new || place < cases.first)
        cases.first = place;
    return {};
}

void Warnings::print(const char* verb) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [kind, cases] : kinds_) {
        std::string where = cases.count > 1 ? std::to_string(cases.count) + " times" : "";
        if (!cases.first.empty())
            where += (where.empty() ? "in " : ", first in ") + printable(cases.first);
        std::fprintf(stderr, "tessera %s: warning: %s%s\n", verb, printable(kind).c_str(),
                     where.empty() ? "" : (" (" + where + ")").c_str());
    }
}

Json Warnings::json() const {
    const std::lock_guard lock(mutex_);
    Json list = Json::array();
    for (const auto& [kind, cases] : kinds_)
        list.push_back({{"warning", printable(kind)},
                        {"count", cases.count},
                        {"first", printable(cases.first)}});
    return list;
}

} // namespace tessera
