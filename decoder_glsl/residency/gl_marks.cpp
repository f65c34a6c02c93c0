#include "decoder_glsl/residency/gl_marks.h"

#include <utility>

namespace tessera {
namespace {

constexpr std::uint32_t send_timeout = 10000, receive_timeout = 60000; // milliseconds

} // namespace

Result<GlMarks> GlMarks::create(std::shared_ptr<GlMarksBuffer> buffer, std::uint64_t first,
                                std::uint64_t tiles) {
    GlMarks m;
    m.buffer_ = std::move(buffer);
    m.begin_ = first * 4;
    m.newest_.resize(static_cast<std::size_t>(tiles));
    for (InFlight& marks : m.in_flight_) {
        TESSERA_TRY_ASSIGN(marks.copy, GlBuffer::create(m.size(), BufferUse::device, "marks copy"));
    }
    return m;
}

Status GlMarks::clear() {
    for (InFlight& marks : in_flight_)
        marks.fence.reset();
    return clear_words();
}

Status GlMarks::clear_words() {
    return buffer_->words.clear(0, begin_, size());
}

Status GlMarks::send() {
    InFlight& next = in_flight_[next_];
    if (next.fence) { // all copies are in use
        TESSERA_TRY(next.fence->wait(send_timeout));
        TESSERA_TRY(read(next));
    }
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glCopyNamedBufferSubData(buffer_->words.id(), next.copy.id(), static_cast<GLintptr>(begin_), 0,
                             static_cast<GLsizeiptr>(size()));
    TESSERA_TRY(clear_words());
    TESSERA_TRY_ASSIGN(auto fence, GlFence::insert());
    next.fence.emplace(std::move(fence));
    next_ = (next_ + 1) % most_frames;
    return {};
}

Result<bool> GlMarks::receive(bool wait) {
    bool current = false;
    for (std::size_t i = 0; i < most_frames;
         ++i) { // the oldest first: newer marks replace older ones
        InFlight& marks = in_flight_[(next_ + i) % most_frames];
        if (!marks.fence)
            continue;
        if (wait)
            TESSERA_TRY(marks.fence->wait(receive_timeout));
        else if (!marks.fence->passed())
            break;
        TESSERA_TRY(read(marks));
        current = i + 1 == most_frames;
    }
    return current;
}

Status GlMarks::read(InFlight& marks) {
    marks.fence.reset();
    TESSERA_TRY(marks.copy.read(0, std::as_writable_bytes(std::span(newest_))));
    is_new_ = true;
    return {};
}

std::optional<std::span<const std::uint32_t>> GlMarks::take_newest() {
    if (!std::exchange(is_new_, false))
        return std::nullopt;
    return newest_;
}

} // namespace tessera
