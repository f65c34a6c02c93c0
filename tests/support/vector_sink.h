// Appends the output of a container writer to a vector.
#pragma once

#include "format/container/container_writer.h"

#include <vector>

namespace tessera::test {

class VectorSink : public ByteSink {
public:
    explicit VectorSink(std::vector<std::byte>& out) : out_(out) {}
    Status append(std::span<const std::byte> bytes) override {
        out_.insert(out_.end(), bytes.begin(), bytes.end());
        return {};
    }

private:
    std::vector<std::byte>& out_;
};

} // namespace tessera::test
