// libtessera.so is made of the static libraries; a library needs a source of its own to exist.
