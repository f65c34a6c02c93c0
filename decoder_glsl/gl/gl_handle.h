// Owns an OpenGL object.
#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace tessera {

// Move-only; 0 stands for no object. The context that is current at destruction must be the one
// that created the object, or share objects with it. `Release` is a function object that takes a
// GLuint.
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
