#include "tools/support/copy_bytes.h"

#include "tools/support/interrupt.h"

#include <algorithm>
#include <vector>

namespace tessera {

Status copy_bytes(ByteSource& from, OutputFile& to) {
    constexpr std::size_t at_once = 1 << 20;
    std::vector<std::byte> piece;
    for (std::uint64_t at = 0; at < from.size(); at += piece.size()) {
        TESSERA_TRY(check_interrupt());
        piece.resize(std::min<std::uint64_t>(at_once, from.size() - at));
        TESSERA_TRY(from.read(at, piece));
        TESSERA_TRY(to.append(piece));
    }
    return {};
}

} // namespace tessera
