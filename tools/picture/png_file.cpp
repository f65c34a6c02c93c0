#include "tools/picture/png_file.h"

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <png.h>

namespace tessera {
namespace {

constexpr std::uint64_t max_interlaced_bytes = 1ull << 30; // an interlaced picture is held whole

constexpr std::uint64_t best_deflate = 1032; // bytes that a byte can stand for
constexpr std::uint64_t end_bytes = 1 << 16; // in which a PNG has its end; some have more behind it

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

struct Started {
    PngShape shape;
    std::uint64_t stored_bytes = 0; // of all rows before they are packed
    int passes = 1;
    std::size_t row_bytes = 0; // as read_row() gives them
};

bool start_reading(Reader& r, PngSamples samples, Started& started) {
    if (setjmp(png_jmpbuf(r.png)))
        return false;
    png_set_read_fn(r.png, &r, read_bytes);
    png_set_user_limits(r.png, 1u << 20, 1u << 20);
    png_set_chunk_malloc_max(r.png, 1u << 20);
    png_read_info(r.png, r.info);
    PngShape& found = started.shape;
    found.width = png_get_image_width(r.png, r.info);
    found.height = png_get_image_height(r.png, r.info);
    found.bits = png_get_bit_depth(r.png, r.info) == 16 ? 16 : 8;
    started.stored_bytes = std::uint64_t{png_get_rowbytes(r.png, r.info)} * found.height;
    png_set_expand(r.png); // palettes, few bits, transparent colours
    if (found.bits == 16) {
        if (samples == PngSamples::eight)
            png_set_scale_16(r.png);
        else if (std::endian::native == std::endian::little)
            png_set_swap(r.png);
    }
    started.passes = png_set_interlace_handling(r.png);
    png_read_update_info(r.png, r.info);
    found.channels = png_get_channels(r.png, r.info);
    started.row_bytes = png_get_rowbytes(r.png, r.info);
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

using PngRowFunction = std::function<void(std::uint32_t, std::span<const std::byte>)>;

Status read_interlaced(Reader& r, const Started& started, std::uint32_t rows,
                       const PngRowFunction& row, const std::string& path, const Failure& failure) {
    const std::size_t line = started.row_bytes;
    const std::uint32_t height = started.shape.height;
    if (line > max_interlaced_bytes / height)
        return {ErrorCode::unsupported, path + ": interlaced and too large"};
    std::vector<std::byte> pixels(line * height);
    std::vector<png_bytep> pointers(height);
    for (std::uint32_t y = 0; y < height; ++y)
        pointers[y] = reinterpret_cast<png_bytep>(pixels.data() + y * line);
    if (!read_whole(r, pointers.data()))
        return r.error(std::string(": ") + failure.text);
    for (std::uint32_t y = 0; y < rows; ++y)
        row(y, {pixels.data() + y * line, line});
    return {};
}

Status start(Reader& r, PngSamples samples, const std::string& path, Failure& failure,
             Started& started) {
    r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning);
    r.info = r.png ? png_create_info_struct(r.png) : nullptr;
    if (!r.info)
        return {ErrorCode::runtime, path + ": libpng does not start"};
    return start_reading(r, samples, started) ? Status()
                                              : r.error(std::string(": ") + failure.text);
}

// That the file was not cut off, before minutes go by.
Status check_whole(ByteSource& file, std::uint64_t stored_bytes) {
    if (stored_bytes / best_deflate > file.size())
        return {ErrorCode::invalid_file, file.name() +
                                             ": damaged PNG: " + std::to_string(file.size()) +
                                             " bytes cannot hold its pixels"};
    std::string tail(std::min(file.size(), end_bytes), '\0');
    TESSERA_TRY(file.read(file.size() - tail.size(), std::as_writable_bytes(std::span(tail))));
    return tail.find("IEND") != std::string::npos
               ? Status()
               : Status(ErrorCode::invalid_file, file.name() + ": damaged PNG: it ends too early");
}

} // namespace

Result<PngShape> read_png_shape(ByteSource& file) {
    const std::string path = file.name();
    unsigned char head[16] = {}; // signature, and the first chunk's length and name
    if (file.size() >= sizeof head)
        TESSERA_TRY(file.read(0, std::as_writable_bytes(std::span(head))));
    if (png_sig_cmp(head, 0, 8) != 0 || std::memcmp(head + 12, "IHDR", 4) != 0)
        return Status(ErrorCode::invalid_file, path + ": not a PNG picture");
    Failure failure;
    Reader r(file);
    Started started;
    TESSERA_TRY(start(r, PngSamples::eight, path, failure, started));
    TESSERA_TRY(check_whole(file, started.stored_bytes));
    return started.shape;
}

Status read_png(ByteSource& file, const PngShape& shape, std::uint32_t rows,
                const PngRowFunction& row, PngSamples samples) {
    const std::string path = file.name();
    Failure failure;
    Reader r(file);
    Started started;
    TESSERA_TRY(start(r, samples, path, failure, started));
    if (started.shape != shape)
        return {ErrorCode::invalid_file, path + ": changed while it was read"};
    if (started.passes > 1)
        return read_interlaced(r, started, rows, row, path, failure);
    std::vector<std::byte> bytes(started.row_bytes);
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
