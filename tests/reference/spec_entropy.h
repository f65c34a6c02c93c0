// The entropy coder (FORMAT.md 3.3).
#pragma once

#include "tests/reference/spec_notation.h"

namespace tessera_reference::spec {

// c[0] = 0 < c[1] < ... < c[m] = 4096
using Table = std::vector<uint32_t>;

class Stream {
public:
    Stream() : Stream(Bytes{}) {}
    explicit Stream(Bytes bytes) : bytes_(bytes) {
        require(bytes.size() % 2 == 0, "stream: odd length");
        refill();
        refill();
    }
    int symbol(const Table& c) {
        const uint32_t r = x_ % 4096;
        size_t i = 0;
        while (c[i + 1] <= r)
            ++i;
        x_ = (c[i + 1] - c[i]) * (x_ / 4096) + r - c[i];
        refill();
        return static_cast<int>(i);
    }
    bool bit(uint32_t f) {
        const uint32_t r = x_ % 4096;
        const bool one = r >= f;
        x_ = one ? (4096 - f) * (x_ / 4096) + r - f : f * (x_ / 4096) + r;
        refill();
        return one;
    }
    uint32_t raw(int n) {
        const uint32_t value = x_ & ((1u << n) - 1);
        x_ >>= n;
        refill();
        return value;
    }
    bool ends_well() const { return x_ == 0 && at_ == bytes_.size(); }

private:
    void refill() {
        if (x_ < 65536 && at_ < bytes_.size()) {
            x_ = x_ * 65536 + u16(bytes_, at_);
            at_ += 2;
        }
    }

    Bytes bytes_;
    size_t at_ = 0;
    uint32_t x_ = 0;
};

} // namespace tessera_reference::spec
