// PNG files that tests write by libpng into memory.
#pragma once

#include <png.h>
#include <string>

namespace tessera::test {

// `file` receives what `out` writes, and must outlive it.
inline void write_png_to(png_structp out, std::string& file) {
    png_set_write_fn(
        out, &file,
        [](png_structp p, png_bytep data, std::size_t size) {
            static_cast<std::string*>(png_get_io_ptr(p))
                ->append(reinterpret_cast<char*>(data), size);
        },
        nullptr);
}

} // namespace tessera::test
