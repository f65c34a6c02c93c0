#include "tools/picture/png_file.h"

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <png.h>

namespace tessera {
namespace {

constexpr std::uint64_t max_interlaced_bytes = 1ull << 30; // an interlaced picture is held whole

constexpr std::size_t head_bytes = 29; // signature and IHDR

std::uint32_t big_endian(const unsigned char* b) {
    return std::uint32_t{b[0]} << 24 | std::uint32_t{b[1]} << 16 | std::uint32_t{b[2]} << 8 | b[3];
}

// libpng reports through a long jump, so the functions that it may leave own nothing.

struct Failure {
    char text[200] = "";
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
    auto* failure = static_cast<Failure*>(png_get_error_ptr(png));
    std::snprintf(failure->text, sizeof failure->text, "%s", message);
    longjmp(png_jmpbuf(png), 1);
}

void on_warning(png_structp, png_const_charp) {}

struct Reader {
    explicit Reader(ByteSource& file) : file_(file) {}
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }

    bool read(std::span<std::byte> out) {
        if (out.size() > file_.size() - position_)
            return false;
        status = file_.read(position_, out);
        position_ += out.size();
        return status.ok();
    }
    // Why libpng gave up: the medium, or the picture.
    Status error(const std::string& text) const {
        return status.ok() ? Status(ErrorCode::invalid_file, file_.name() + ": damaged PNG" + text)
                           : status;
    }

    png_structp png = nullptr;
    png_infop info = nullptr;
    Status status; // of the last read

private:
    ByteSource& file_;
    std::uint64_t position_ = 0;
};

void read_bytes(png_structp png, png_bytep data, std::size_t size) {
    auto* reader = static_cast<Reader*>(png_get_io_ptr(png));
    if (!reader->read({reinterpret_cast<std::byte*>(data), size}))
        png_error(png, "it ends too early");
}

bool start_reading(Reader& r, PngShape& found, bool& plain, int& passes) {
    if (setjmp(png_jmpbuf(r.png)))
        return false;
    png_set_read_fn(r.png, &r, read_bytes);
    png_set_user_limits(r.png, 1u << 20, 1u << 20);
    png_set_chunk_malloc_max(r.png, 1u << 20);
    png_read_info(r.png, r.info);
    found.width = png_get_image_width(r.png, r.info);
    found.height = png_get_image_height(r.png, r.info);
    found.channels = png_get_channels(r.png, r.info);
    plain = png_get_bit_depth(r.png, r.info) == 8 &&
            png_get_color_type(r.png, r.info) != PNG_COLOR_TYPE_PALETTE;
    passes = png_set_interlace_handling(r.png);
    png_read_update_info(r.png, r.info);
    return true;
}

bool read_row(Reader& r, std::byte* row) {
    if (setjmp(png_jmpbuf(r.png)))
        return false;
    png_read_row(r.png, reinterpret_cast<png_bytep>(row), nullptr);
    return true;
}

bool read_whole(Reader& r, png_bytepp rows) {
    if (setjmp(png_jmpbuf(r.png)))
        return false;
    png_read_image(r.png, rows);
    return true;
}

struct Writer {
    png_structp png = nullptr;
    png_infop info = nullptr;
    ~Writer() { png_destroy_write_struct(&png, &info); }
};

void append_bytes(png_structp png, png_bytep data, std::size_t size) {
    auto* out = static_cast<std::vector<std::byte>*>(png_get_io_ptr(png));
    bool grown = true;
    try {
        out->insert(out->end(), reinterpret_cast<std::byte*>(data),
                    reinterpret_cast<std::byte*>(data) + size);
    } catch (const std::exception&) {
        grown = false;
    }
    if (!grown) // not inside the handler: the jump must not cross it
        png_error(png, "out of memory");
}

bool write_picture(Writer& w, const PngShape& shape, const std::byte* pixels) {
    static const int colour_types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                       PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
    if (setjmp(png_jmpbuf(w.png)))
        return false;
    png_set_user_limits(w.png, 1u << 20, 1u << 20); // the default is a little below max_extent
    png_set_IHDR(w.png, w.info, shape.width, shape.height, 8, colour_types[shape.channels - 1],
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(w.png, 4); // twice as fast as 6 for some per cent of size
    png_write_info(w.png, w.info);
    for (std::uint32_t y = 0; y < shape.height; ++y)
        png_write_row(w.png, reinterpret_cast<png_const_bytep>(pixels + y * shape.row_bytes()));
    png_write_end(w.png, nullptr);
    return true;
}

Status read_interlaced(Reader& r, const PngShape& shape, std::uint32_t rows,
                       const std::function<void(std::uint32_t, std::span<const std::byte>)>& row,
                       const std::string& path, const Failure& failure) {
    if (shape.row_bytes() > max_interlaced_bytes / shape.height)
        return {ErrorCode::unsupported, path + ": interlaced and too large"};
    std::vector<std::byte> pixels(shape.row_bytes() * shape.height);
    std::vector<png_bytep> pointers(shape.height);
    for (std::uint32_t y = 0; y < shape.height; ++y)
        pointers[y] = reinterpret_cast<png_bytep>(pixels.data() + y * shape.row_bytes());
    if (!read_whole(r, pointers.data()))
        return r.error(std::string(": ") + failure.text);
    for (std::uint32_t y = 0; y < rows; ++y)
        row(y, {pixels.data() + y * shape.row_bytes(), shape.row_bytes()});
    return {};
}

} // namespace

Result<PngShape> read_png_shape(ByteSource& file) {
    const std::string path = file.name();
    unsigned char head[head_bytes] = {};
    if (file.size() >= head_bytes)
        TESSERA_TRY(file.read(0, std::as_writable_bytes(std::span(head))));
    if (png_sig_cmp(head, 0, 8) != 0 || std::memcmp(head + 12, "IHDR", 4) != 0)
        return Status(ErrorCode::invalid_file, path + ": not a PNG picture");
    static const std::uint8_t channels[] = {1, 0, 3, 0, 2, 0, 4};
    const unsigned depth = head[24], colour = head[25];
    const PngShape shape{big_endian(head + 16), big_endian(head + 20),
                         colour < 7 ? channels[colour] : std::uint8_t{0}};
    if (depth != 8 || shape.channels == 0)
        return Status(ErrorCode::unsupported,
                      path + ": a PNG of " + std::to_string(depth) + " bits and colour type " +
                          std::to_string(colour) +
                          "; views are 8-bit grey, grey + alpha, RGB or RGB + alpha (EXR holds "
                          "more)");
    if (shape.width == 0 || shape.height == 0)
        return Status(ErrorCode::invalid_file, path + ": a PNG of no pixels");
    return shape;
}

Status read_png(ByteSource& file, const PngShape& shape, std::uint32_t rows,
                const std::function<void(std::uint32_t, std::span<const std::byte>)>& row) {
    const std::string path = file.name();
    Failure failure;
    Reader r(file);
    r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning);
    r.info = r.png ? png_create_info_struct(r.png) : nullptr;
    if (!r.info)
        return {ErrorCode::runtime, path + ": libpng does not start"};
    PngShape found;
    bool plain = false;
    int passes = 1;
    if (!start_reading(r, found, plain, passes))
        return r.error(std::string(": ") + failure.text);
    if (found != shape || !plain)
        return {ErrorCode::invalid_file, path + ": changed while it was read"};
    if (passes > 1)
        return read_interlaced(r, shape, rows, row, path, failure);
    std::vector<std::byte> bytes(shape.row_bytes());
    for (std::uint32_t y = 0; y < rows; ++y) {
        if (!read_row(r, bytes.data()))
            return r.error(" in row " + std::to_string(y) + ": " + failure.text);
        row(y, bytes);
    }
    return {};
}

Result<PngShape> read_png_shape(const std::string& path) {
    const auto file = open_file(path);
    return file.ok() ? read_png_shape(**file) : Result<PngShape>(file.status());
}

Status read_png(const std::string& path, const PngShape& shape, std::uint32_t rows,
                const std::function<void(std::uint32_t, std::span<const std::byte>)>& row) {
    const auto file = open_file(path);
    return file.ok() ? read_png(**file, shape, rows, row) : file.status();
}

Result<std::vector<std::byte>> encode_png(const PngShape& shape,
                                          std::span<const std::byte> pixels) {
    if (shape.channels < 1 || shape.channels > 4 ||
        pixels.size() != shape.row_bytes() * shape.height)
        return Status(ErrorCode::bad_argument, "the pixels do not fit the picture");
    std::vector<std::byte> out;
    Failure failure;
    Writer w;
    w.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning);
    w.info = w.png ? png_create_info_struct(w.png) : nullptr;
    if (!w.info)
        return Status(ErrorCode::runtime, "libpng does not start");
    png_set_write_fn(w.png, &out, append_bytes, nullptr);
    if (!write_picture(w, shape, pixels.data()))
        return Status(ErrorCode::runtime, std::string("PNG: ") + failure.text);
    return out;
}

} // namespace tessera
