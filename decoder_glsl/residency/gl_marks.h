// The marks of the tiles that frames sample: shaders write them, the host reads them back.
#pragma once

#include "decoder_glsl/gl/gl_buffer.h"
#include "decoder_glsl/gl/gl_sync.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace tessera {

// The buffer that shaders write, one word per tile. Textures that one program samples share it.
struct GlMarksBuffer {
    GlBuffer words;
    GLuint binding; // of sample.glsl
};

// The marks of one texture, in a part of that buffer. Marks of up to three frames can be on their way
// back, so that no frame has to wait for the device. Every call and the destructor need a current
// OpenGL 4.5 context.
class GlMarks {
public:
    // The marks of `tiles` tiles from word `first` on. Errors: runtime (no memory).
    static Result<GlMarks> create(std::shared_ptr<GlMarksBuffer> buffer, std::uint64_t first,
                                  std::uint64_t tiles);
    // Bytes on the device.
    static std::uint64_t bytes_for(std::uint64_t tiles) { return tiles * 4 * (1 + most_frames); }

    // Binds the buffer that shaders write.
    void bind() const { buffer_->words.bind_storage(buffer_->binding); }
    // The word of the first tile's mark.
    std::uint32_t first() const { return static_cast<std::uint32_t>(begin_ / 4); }
    // Forgets all marks, also those on their way back.
    Status clear();
    // Ends a frame: sends its marks on their way back and clears them for the next frame. Waits
    // only if three frames are unfinished. Errors: runtime (the device takes longer than 10 s).
    Status send();
    // Receives the marks of finished frames, or of all frames if `wait`. Returns whether those of
    // the last frame are among them. Errors: runtime (the device takes longer than 60 s).
    Result<bool> receive(bool wait);
    // The newest marks that were received since the last call, one word per tile that is not 0 if
    // the tile was sampled; none if there are no newer ones. Valid until the next call of any
    // function.
    std::optional<std::span<const std::uint32_t>> take_newest();

    std::uint64_t bytes() const { return bytes_for(newest_.size()); }

private:
    static constexpr std::size_t most_frames = 3;

    struct InFlight {
        GlBuffer copy;
        std::optional<GlFence> fence; // behind the copy
    };
    Status read(InFlight& marks);
    Status clear_words();
    std::uint64_t size() const { return newest_.size() * 4; } // bytes

    std::shared_ptr<GlMarksBuffer> buffer_;
    std::uint64_t begin_ = 0; // bytes
    std::array<InFlight, most_frames> in_flight_;
    std::size_t next_ = 0; // of in_flight_, to send: the oldest one
    std::vector<std::uint32_t> newest_;
    bool is_new_ = false;
};

} // namespace tessera
