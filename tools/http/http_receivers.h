// Receives and checks responses: the one that opens a file, and each part after that.
#pragma once

#include "tools/http/http_transfers.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// The version of a file that a response belongs to.
struct HttpVersion {
    std::uint64_t size = 0; // bytes of the whole file
    std::string etag, last_modified;
};

// Receives the first `wanted` bytes of a file, or all of it if the server does not support ranges.
// Refuses a whole file of more than `max_whole` bytes.
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

// Receives one part of a file whose version is known.
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
