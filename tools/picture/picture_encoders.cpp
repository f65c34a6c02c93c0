#include "tools/picture/picture_encoders.h"

#include <csetjmp>
#include <cstdio> // before jpeglib.h, which needs it
#include <cstdlib>
#include <exception>
#include <jpeglib.h>
#include <png.h>
#include <string>

namespace tessera {
namespace {

// Both libraries report errors by a long jump. Functions that call setjmp() therefore hold no
// object with a destructor.

struct PngWriter {
    PngWriter() {
        png = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, on_error,
                                      [](png_structp, png_const_charp) {});
        info = png ? png_create_info_struct(png) : nullptr;
    }
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;
    ~PngWriter() { png_destroy_write_struct(&png, &info); }

    [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
        auto* writer = static_cast<PngWriter*>(png_get_error_ptr(png));
        std::snprintf(writer->text, sizeof writer->text, "%s", message);
        longjmp(png_jmpbuf(png), 1);
    }
    static void append(png_structp png, png_bytep data, std::size_t size) {
        auto& out = static_cast<PngWriter*>(png_get_io_ptr(png))->bytes;
        bool has_grown = true;
        try {
            out.insert(out.end(), reinterpret_cast<std::byte*>(data),
                       reinterpret_cast<std::byte*>(data) + size);
        } catch (const std::exception&) {
            has_grown = false;
        }
        if (!has_grown) // not inside the handler: the jump must not cross it
            png_error(png, "out of memory");
    }

    png_structp png = nullptr;
    png_infop info = nullptr;
    char text[200] = "";
    std::vector<std::byte> bytes;
};

bool write_picture(PngWriter& w, const PixelSize& size, const std::byte* pixels) {
    static const int colour_types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                       PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
    if (setjmp(png_jmpbuf(w.png)))
        return false;
    png_set_write_fn(w.png, &w, PngWriter::append, nullptr);
    png_set_user_limits(w.png, 1u << 20, 1u << 20); // the default is a little below max_extent
    png_set_IHDR(w.png, w.info, size.width, size.height, 8, colour_types[size.channels - 1],
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(w.png, 4); // twice as fast as 6, and a few per cent larger
    png_write_info(w.png, w.info);
    for (std::uint32_t y = 0; y < size.height; ++y)
        png_write_row(w.png, reinterpret_cast<png_const_bytep>(pixels + y * size.row_bytes()));
    png_write_end(w.png, nullptr);
    return true;
}

struct JpegWriter {
    JpegWriter() {
        codec.err = jpeg_std_error(&errors);
        codec.client_data = this;
        errors.error_exit = on_error;
    }
    JpegWriter(const JpegWriter&) = delete;
    JpegWriter& operator=(const JpegWriter&) = delete;
    ~JpegWriter() {
        jpeg_destroy_compress(&codec);
        std::free(bytes);
    }
    [[noreturn]] static void on_error(j_common_ptr codec) {
        auto* writer = static_cast<JpegWriter*>(codec->client_data);
        (*codec->err->format_message)(codec, writer->text);
        std::longjmp(writer->jump, 1);
    }

    jpeg_compress_struct codec{};
    jpeg_error_mgr errors{};
    std::jmp_buf jump{};
    char text[JMSG_LENGTH_MAX] = "";
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
};

bool write_picture(JpegWriter& w, const PixelSize& size, const std::byte* pixels, int quality) {
    if (setjmp(w.jump))
        return false;
    jpeg_create_compress(&w.codec);
    jpeg_mem_dest(&w.codec, &w.bytes, &w.size);
    w.codec.image_width = size.width;
    w.codec.image_height = size.height;
    w.codec.input_components = size.channels;
    w.codec.in_color_space = size.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&w.codec);
    jpeg_set_quality(&w.codec, quality, TRUE);
    w.codec.comp_info[0].h_samp_factor = w.codec.comp_info[0].v_samp_factor = 1;
    w.codec.dct_method = JDCT_ISLOW;
    jpeg_start_compress(&w.codec, TRUE);
    for (std::uint32_t y = 0; y < size.height; ++y) {
        auto* row =
            reinterpret_cast<JSAMPROW>(const_cast<std::byte*>(pixels + y * size.row_bytes()));
        jpeg_write_scanlines(&w.codec, &row, 1);
    }
    jpeg_finish_compress(&w.codec);
    return true;
}

} // namespace

Result<std::vector<std::byte>> encode_png(const PixelSize& size,
                                          std::span<const std::byte> pixels) {
    if (size.channels < 1 || size.channels > 4 || pixels.size() != size.row_bytes() * size.height)
        return Status(ErrorCode::bad_argument, "the pixels do not fit the picture");
    PngWriter w;
    if (!w.info)
        return Status(ErrorCode::runtime, "libpng does not start");
    if (!write_picture(w, size, pixels.data()))
        return Status(ErrorCode::runtime, std::string("PNG: ") + w.text);
    return std::move(w.bytes);
}

Result<std::vector<std::byte>> encode_jpeg(const PixelSize& size, std::span<const std::byte> pixels,
                                           int quality) {
    if ((size.channels != 1 && size.channels != 3) || quality < 1 || quality > 100 ||
        pixels.size() != size.row_bytes() * size.height)
        return Status(ErrorCode::bad_argument, "the pixels do not fit a JPEG picture");
    if (size.width > JPEG_MAX_DIMENSION || size.height > JPEG_MAX_DIMENSION)
        return Status(ErrorCode::unsupported, "a JPEG picture has sides of at most " +
                                                  std::to_string(JPEG_MAX_DIMENSION) + " pixels");
    JpegWriter w;
    if (!write_picture(w, size, pixels.data(), quality)) {
        w.bytes = nullptr; // libjpeg may have moved its memory, and reports that only at the end
        return Status(ErrorCode::runtime, std::string("JPEG: ") + w.text);
    }
    const auto* bytes = reinterpret_cast<const std::byte*>(w.bytes);
    return std::vector<std::byte>(bytes, bytes + w.size);
}

} // namespace tessera
