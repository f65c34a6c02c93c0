#include "format/byte_source.h"

#include "format/io/claim_cache.h"

#include <algorithm>
#include <mutex>
#include <vector>

namespace tessera {
namespace {

constexpr std::uint64_t piece_bytes = 1 << 20;
constexpr std::uint64_t pieces_kept = 16;

class ReadAhead : public ByteSource {
public:
    explicit ReadAhead(ByteSource& inner) : inner_(inner) {}
    std::uint64_t size() const override { return inner_.size(); }
    std::string name() const override { return inner_.name(); }

    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        TESSERA_TRY(check_range(*this, offset, out.size()));
        while (!out.empty()) {
            const std::uint64_t number = offset / piece_bytes;
            TESSERA_TRY_ASSIGN(const auto piece, pieces_.get(number, [&] { return load(number); }));
            const auto from = static_cast<std::size_t>(offset % piece_bytes);
            const std::size_t some = std::min(out.size(), piece->size() - from);
            std::ranges::copy(std::span(*piece).subspan(from, some), out.begin());
            offset += some;
            out = out.subspan(some);
        }
        return {};
    }

private:
    using Bytes = std::vector<std::byte>;

    Result<Bytes> load(std::uint64_t number) {
        const std::uint64_t begin = number * piece_bytes;
        Bytes bytes(static_cast<std::size_t>(std::min(piece_bytes, size() - begin)));
        {
            const std::lock_guard lock(mutex_);
            TESSERA_TRY(failure_);
        }
        if (Status status = inner_.read(begin, bytes); !status.ok()) {
            const std::lock_guard lock(mutex_);
            return failure_ = status;
        }
        return bytes;
    }

    ByteSource& inner_;
    std::mutex mutex_;
    Status failure_; // the first error of inner_
    ClaimCache<Bytes> pieces_{pieces_kept, [](const Bytes&) { return std::uint64_t{1}; }};
};

} // namespace

std::unique_ptr<ByteSource> read_ahead(ByteSource& inner) {
    return std::make_unique<ReadAhead>(inner);
}

} // namespace tessera
