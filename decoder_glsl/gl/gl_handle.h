// The name of an OpenGL object, owned.
#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace tessera {

// Move-only; 0 owns nothing. It is released in the context that is current then, which has to be the
// one that made it, or one that shares objects with it. `Release` is a function object on a GLuint.
template <class Release> class GlHandle {
public:
    GlHandle() = default;
    explicit GlHandle(GLuint id) : id_(id) {}
    GlHandle(GlHandle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    GlHandle& operator=(GlHandle&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    ~GlHandle() {
        if (id_ != 0)
            Release()(id_);
    }
    GLuint get() const { return id_; }

private:
    GLuint id_ = 0;
};

} // namespace tessera
