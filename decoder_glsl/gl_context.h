// An OpenGL context without a window.
#pragma once

#include "format/status.h"

#include <memory>
#include <string>

namespace TESSERA_PUBLIC tessera {

// Desktop OpenGL 4.5 core through EGL. It prefers a GPU, with or without a display attached, to
// Mesa's software rasteriser. Among several GPUs it takes the first that EGL lists.
//
// Movable. A context is current on at most one thread at a time. Destroy the objects created in it
// before the context.
class HeadlessContext {
public:
    // A new context, current on the calling thread. Errors: unsupported (there is no EGL, no EGL
    // display, or no device with OpenGL 4.5; the message says what each device lacks).
    static Result<HeadlessContext> create();

    HeadlessContext(HeadlessContext&&) noexcept;
    HeadlessContext& operator=(HeadlessContext&&) noexcept;
    ~HeadlessContext();

    // Makes it current on the calling thread. Errors: runtime (it is current on another thread).
    Status make_current() const;

    const std::string& vendor() const;  // GL_VENDOR, "Mesa"
    const std::string& device() const;  // GL_RENDERER, "llvmpipe (LLVM 15.0.6, 256 bits)"
    const std::string& version() const; // GL_VERSION, "4.5 (Core Profile) Mesa 22.3.6"
    bool is_software() const;           // the CPU draws, so timings say nothing about GPUs

private:
    struct State;
    explicit HeadlessContext(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace tessera
