// What is asked of a server's answers: at opening, and for every part after that.
#pragma once

#include "tools/http/http_transfers.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// Which version of a file an answer is of.
struct HttpVersion {
    std::uint64_t size = 0; // bytes of the whole file
    std::string etag, last_modified;
};

// Takes the first part of a file, or all of it.
class OpeningReceiver : public HttpReceiver {
public:
    OpeningReceiver(std::uint64_t wanted, std::uint64_t max_whole)
        : wanted_(wanted), max_whole_(max_whole) {}
    Status begin(const HttpHead& head) override;
    Status receive(std::span<const std::byte> bytes) override;
    Status end() override;

    // After end().
    HttpVersion version;
    std::vector<std::byte> bytes; // the first min(wanted, size), or all

private:
    Status begin_whole(const HttpHead& head);
    Status begin_part(const HttpHead& head);

    std::uint64_t wanted_, max_whole_; // bytes
    bool whole_ = false, empty_ = false;
    std::uint64_t expected_ = 0; // bytes; of a part
};

// Takes one part of a file whose version is known.
class PartReceiver : public HttpReceiver {
public:
    // `version` and `out` must outlive it.
    PartReceiver(const HttpVersion& version, std::uint64_t offset, std::span<std::byte> out)
        : version_(version), offset_(offset), out_(out) {}
    Status begin(const HttpHead& head) override;
    Status receive(std::span<const std::byte> bytes) override;
    Status end() override;

private:
    const HttpVersion& version_;
    std::uint64_t offset_;
    std::span<std::byte> out_;
    std::size_t got_ = 0;
};

} // namespace tessera
