#include "corpus/picture/icc.h"
#include "corpus/picture/picture_readers.h"

#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <png.h>

namespace tessera::corpus {
namespace {

constexpr std::uint32_t most_png_side = 1u << 20;
constexpr std::uint64_t most_interlaced_bytes = 1ull << 30; // an interlaced picture is held whole
constexpr std::uint64_t best_deflate = 1032; // bytes of pixels that one byte of a file can hold

// libpng reports errors by a long jump. Functions that call setjmp() therefore hold no object with
// a destructor.
class PngDecoder {
public:
    explicit PngDecoder(ByteSource& file) : file_(file) {
        png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error,
                                     [](png_structp, png_const_charp) {});
        info = png ? png_create_info_struct(png) : nullptr;
    }
    PngDecoder(const PngDecoder&) = delete;
    PngDecoder& operator=(const PngDecoder&) = delete;
    ~PngDecoder() { png_destroy_read_struct(&png, &info, nullptr); }

    // Reads the header. Samples become 8 bits or, if `deep`, may stay 16.
    bool start(bool deep) {
        if (!info)
            return false;
        if (setjmp(png_jmpbuf(png)))
            return false;
        png_set_read_fn(png, this, read_bytes);
        png_set_user_limits(png, most_png_side, most_png_side);
        png_set_chunk_malloc_max(png, 1u << 20);
        png_read_info(png, info);
        bits = png_get_bit_depth(png, info) == 16 ? 16 : 8;
        packed_row_bytes = png_get_rowbytes(png, info);
        png_set_expand(png); // palettes, fewer than 8 bits, transparent colours
        if (bits == 16 && !deep)
            png_set_scale_16(png);
        else if (std::endian::native == std::endian::little)
            png_set_swap(png);
        passes = png_set_interlace_handling(png);
        png_read_update_info(png, info);
        return true;
    }
    bool read_row(std::byte* row) {
        if (setjmp(png_jmpbuf(png)))
            return false;
        png_read_row(png, reinterpret_cast<png_bytep>(row), nullptr);
        return true;
    }
    bool read_all(png_bytepp rows) {
        if (setjmp(png_jmpbuf(png)))
            return false;
        png_read_image(png, rows);
        return true;
    }
    Status error(const std::string& where) const {
        return status_.ok() ? damaged("PNG" + where + ": " + text_) : status_;
    }

    png_structp png = nullptr;
    png_infop info = nullptr;
    std::uint8_t bits = 8;
    std::size_t packed_row_bytes = 0; // before expansion
    int passes = 1;

private:
    [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
        auto* decoder = static_cast<PngDecoder*>(png_get_error_ptr(png));
        std::snprintf(decoder->text_, sizeof decoder->text_, "%s", message);
        longjmp(png_jmpbuf(png), 1);
    }
    static void read_bytes(png_structp png, png_bytep data, std::size_t size) {
        auto* decoder = static_cast<PngDecoder*>(png_get_io_ptr(png));
        if (!decoder->read({reinterpret_cast<std::byte*>(data), size}))
            png_error(png, "it ends too early");
    }
    bool read(std::span<std::byte> out) {
        if (out.size() > file_.size() - position_)
            return false;
        status_ = file_.read(position_, out);
        position_ += out.size();
        return status_.ok();
    }

    ByteSource& file_;
    std::uint64_t position_ = 0;
    Status status_; // of the last read
    char text_[200] = "libpng does not start";
};

class PngReader final : public IntegerReader {
public:
    explicit PngReader(ByteSource& file) : file_(file) {}

    Status open() {
        PngDecoder decoder(file_);
        TESSERA_TRY(start(decoder, false));
        note_colours(decoder);
        // Found now instead of after minutes of decoding.
        if (decoder.packed_row_bytes * shape_.height / best_deflate > file_.size())
            return damaged("PNG: " + std::to_string(file_.size()) +
                           " bytes cannot hold its pixels");
        TESSERA_TRY_ASSIGN(const bool complete, occurs_behind(file_, 8, "IEND"));
        return complete ? Status() : damaged("PNG: it ends too early");
    }

private:
    Status start(PngDecoder& decoder, bool deep) {
        if (!decoder.start(deep))
            return decoder.error("");
        const PictureShape shape{.kind = PictureKind::png,
                                 .width = png_get_image_width(decoder.png, decoder.info),
                                 .height = png_get_image_height(decoder.png, decoder.info),
                                 .channels = png_get_channels(decoder.png, decoder.info),
                                 .bits = decoder.bits};
        if (shape_.kind != PictureKind::none && shape != shape_)
            return {ErrorCode::invalid_file, "changed while it was read"};
        shape_ = shape;
        return {};
    }

    // An sRGB chunk makes the others void.
    void note_colours(const PngDecoder& decoder) {
        int intent = 0, method = 0;
        if (png_get_sRGB(decoder.png, decoder.info, &intent) != 0)
            return;
        png_charp name = nullptr;
        png_bytep profile = nullptr;
        png_uint_32 length = 0;
        if (png_get_iCCP(decoder.png, decoder.info, &name, &method, &profile, &length) != 0) {
            if (std::string note = icc_note(std::as_bytes(std::span(profile, length)), name);
                !note.empty())
                notes_.push_back(std::move(note));
            return;
        }
        double gamma = 0;
        if (png_get_gAMA(decoder.png, decoder.info, &gamma) == 0 || std::abs(gamma - 0.4545) < 0.02)
            return;
        char text[80];
        std::snprintf(text, sizeof text, "the gamma %.4g of a PNG is ignored, sRGB is assumed",
                      gamma);
        notes_.emplace_back(text);
    }

    Status decode(bool deep, std::uint32_t last, const PictureRow& row) override {
        PngDecoder decoder(file_);
        TESSERA_TRY(start(decoder, deep));
        std::vector<std::byte> bytes(png_get_rowbytes(decoder.png, decoder.info));
        if (decoder.passes > 1)
            return decode_interlaced(decoder, bytes.size(), last, row);
        for (std::uint32_t y = 0; y < last; ++y) {
            if (!decoder.read_row(bytes.data()))
                return decoder.error(" in row " + std::to_string(y));
            row(y, bytes);
        }
        return {};
    }

    Status decode_interlaced(PngDecoder& decoder, std::size_t line, std::uint32_t last,
                             const PictureRow& row) const {
        if (line > most_interlaced_bytes / shape_.height)
            return {ErrorCode::unsupported, "interlaced and too large"};
        std::vector<std::byte> pixels(line * shape_.height);
        std::vector<png_bytep> rows(shape_.height);
        for (std::uint32_t y = 0; y < shape_.height; ++y)
            rows[y] = reinterpret_cast<png_bytep>(pixels.data() + y * line);
        if (!decoder.read_all(rows.data()))
            return decoder.error("");
        for (std::uint32_t y = 0; y < last; ++y)
            row(y, {pixels.data() + y * line, line});
        return {};
    }

    ByteSource& file_;
};

} // namespace

Result<std::unique_ptr<PictureReader>> open_png(ByteSource& file) {
    auto reader = std::make_unique<PngReader>(file);
    TESSERA_TRY(reader->open());
    return std::unique_ptr<PictureReader>(std::move(reader));
}

} // namespace tessera::corpus
