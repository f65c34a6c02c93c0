#include "corpus/picture/exif.h"
#include "corpus/picture/icc.h"
#include "corpus/picture/picture_readers.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio> // before jpeglib.h, which needs it
#include <cstdlib>
#include <cstring>
#include <jerror.h>
#include <jpeglib.h>

namespace tessera::corpus {
namespace {

// Coefficients of a progressive picture are held whole.
constexpr std::uint64_t most_progressive_bytes = 1ull << 30;
// Huffman codes take at least one bit per block of 8x8 pixels.
constexpr std::uint64_t most_blocks_per_byte = 8;
// Later scans may be nearly empty. Ordinary files have about ten; 32 scans of a flat picture reach
// this limit.
constexpr std::uint64_t most_scanned_blocks_per_byte = 256;

// libjpeg reports errors by a long jump. Functions that call setjmp() therefore hold no object with
// a destructor.
class JpegDecoder {
public:
    explicit JpegDecoder(ByteSource& file) : file_(file) {
        codec.err = jpeg_std_error(&errors_);
        codec.client_data = this;
        errors_.error_exit = fail;
        errors_.emit_message = on_message;
    }
    JpegDecoder(const JpegDecoder&) = delete;
    JpegDecoder& operator=(const JpegDecoder&) = delete;
    ~JpegDecoder() { jpeg_destroy_decompress(&codec); }

    // Reads the header.
    bool start() {
        if (setjmp(jump_))
            return false;
        jpeg_create_decompress(&codec);
        source_.init_source = [](j_decompress_ptr) {};
        source_.term_source = [](j_decompress_ptr) {};
        source_.fill_input_buffer = fill_input;
        source_.skip_input_data = skip_input;
        source_.resync_to_restart = jpeg_resync_to_restart;
        codec.src = &source_;
        progress_.progress_monitor = watch_scans;
        codec.progress = &progress_;
        jpeg_save_markers(&codec, JPEG_APP0 + 1, 0xFFFF); // EXIF
        jpeg_save_markers(&codec, JPEG_APP0 + 2, 0xFFFF); // a colour profile
        jpeg_read_header(&codec, TRUE);
        codec.out_color_space = codec.num_components == 1   ? JCS_GRAYSCALE
                                : codec.num_components == 4 ? JCS_CMYK
                                                            : JCS_RGB;
        codec.dct_method = JDCT_ISLOW; // the same texels on every machine
        return true;
    }
    // Behind what start() read.
    std::uint64_t position() const { return position_ - source_.bytes_in_buffer; }
    // What the first EXIF segment states.
    Orientation orientation() const {
        for (auto* marker = codec.marker_list; marker != nullptr; marker = marker->next)
            if (const auto found =
                    exif_orientation(std::as_bytes(std::span(marker->data, marker->data_length)));
                found != Orientation::top_left)
                return found;
        return Orientation::top_left;
    }
    // Empty where there is none, or where it is damaged.
    std::vector<std::byte> profile() {
        JOCTET* bytes = nullptr;
        unsigned int length = 0;
        std::vector<std::byte> copy;
        if (find_profile(bytes, length)) {
            copy.resize(length);
            std::memcpy(copy.data(), bytes, length);
        }
        std::free(bytes);
        return copy;
    }
    std::uint64_t blocks() const {
        return (std::uint64_t{codec.image_width} + 7) / 8 * ((codec.image_height + 7ull) / 8);
    }
    bool start_rows() {
        if (setjmp(jump_))
            return false;
        return jpeg_start_decompress(&codec) == TRUE;
    }
    bool read_row(std::byte* row) {
        if (setjmp(jump_))
            return false;
        auto* line = reinterpret_cast<JSAMPROW>(row);
        return jpeg_read_scanlines(&codec, &line, 1) == 1;
    }
    Status error() const { return status_.ok() ? damaged(std::string("JPEG: ") + text_) : status_; }

    jpeg_decompress_struct codec{};

private:
    bool find_profile(JOCTET*& bytes, unsigned int& length) {
        if (setjmp(jump_))
            return false;
        return jpeg_read_icc_profile(&codec, &bytes, &length) == TRUE;
    }
    static JpegDecoder& of(j_common_ptr codec) {
        return *static_cast<JpegDecoder*>(codec->client_data);
    }
    [[noreturn]] static void fail(j_common_ptr codec) {
        (*codec->err->format_message)(codec, of(codec).text_);
        std::longjmp(of(codec).jump_, 1);
    }
    // Warnings report damage, except for three that do not concern the pixels.
    static void on_message(j_common_ptr codec, int level) {
        const int code = codec->err->msg_code;
        if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_ADOBE_XFORM &&
            code != JWRN_JFIF_MAJOR)
            fail(codec);
    }
    static boolean fill_input(j_decompress_ptr codec) {
        if (!of(reinterpret_cast<j_common_ptr>(codec)).fill())
            ERREXIT(codec, JERR_INPUT_EOF);
        return TRUE;
    }
    bool fill() {
        const std::size_t count = std::min<std::uint64_t>(sizeof buffer_, file_.size() - position_);
        if (count == 0)
            return false;
        status_ = file_.read(position_, std::as_writable_bytes(std::span(buffer_, count)));
        position_ += count;
        source_.next_input_byte = buffer_;
        source_.bytes_in_buffer = count;
        return status_.ok();
    }
    static void skip_input(j_decompress_ptr codec, long count) {
        while (count > static_cast<long>(codec->src->bytes_in_buffer)) {
            count -= static_cast<long>(codec->src->bytes_in_buffer);
            fill_input(codec);
        }
        if (count <= 0)
            return;
        codec->src->next_input_byte += count;
        codec->src->bytes_in_buffer -= static_cast<std::size_t>(count);
    }
    static void watch_scans(j_common_ptr codec) {
        JpegDecoder& self = of(codec);
        const auto scans = static_cast<std::uint64_t>(self.codec.input_scan_number);
        if (scans == 1 || scans * self.blocks() <= most_scanned_blocks_per_byte * self.file_.size())
            return;
        std::snprintf(self.text_, sizeof self.text_, "too many scans");
        std::longjmp(self.jump_, 1);
    }

    ByteSource& file_;
    jpeg_error_mgr errors_{};
    jpeg_source_mgr source_{};
    jpeg_progress_mgr progress_{};
    std::jmp_buf jump_{};
    std::uint64_t position_ = 0; // of the file, behind the buffer
    Status status_;              // of the last read
    char text_[JMSG_LENGTH_MAX] = "";
    JOCTET buffer_[1 << 16];
};

class JpegReader final : public IntegerReader {
public:
    explicit JpegReader(ByteSource& file) : file_(file) {}

    Status open() {
        JpegDecoder decoder(file_);
        TESSERA_TRY(start(decoder));
        orientation_ = decoder.orientation();
        if (const auto profile = decoder.profile(); !profile.empty())
            if (std::string note = icc_note(profile); !note.empty())
                notes_.push_back(std::move(note));
        // Found now instead of after minutes of decoding. An arithmetic code has no least length.
        if (decoder.blocks() / most_blocks_per_byte > file_.size() && !decoder.codec.arith_code)
            return damaged("JPEG: " + std::to_string(file_.size()) +
                           " bytes cannot hold its pixels");
        TESSERA_TRY_ASSIGN(const bool complete,
                           occurs_behind(file_, decoder.position(), "\xff\xd9"));
        return complete ? Status() : damaged("JPEG: it ends too early");
    }
    Orientation orientation() const { return orientation_; }

private:
    Status start(JpegDecoder& decoder) {
        if (!decoder.start())
            return decoder.error();
        const auto& codec = decoder.codec;
        const int channels = codec.num_components;
        if (channels != 1 && channels != 3 && channels != 4)
            return not_supported("a JPEG of " + std::to_string(channels) + " channels");
        const std::uint64_t samples = std::uint64_t{codec.image_width} * codec.image_height *
                                      static_cast<std::uint64_t>(channels);
        if (jpeg_has_multiple_scans(&decoder.codec) &&
            samples * sizeof(JCOEF) > most_progressive_bytes)
            return {ErrorCode::unsupported, "a progressive JPEG, and too large"};
        const PictureShape shape{.kind = PictureKind::jpeg,
                                 .width = codec.image_width,
                                 .height = codec.image_height,
                                 .channels = static_cast<std::uint8_t>(channels == 1 ? 1 : 3)};
        if (shape_.kind != PictureKind::none && shape != shape_)
            return {ErrorCode::invalid_file, "changed while it was read"};
        shape_ = shape;
        return {};
    }

    Status decode(bool, std::uint32_t last, const PictureRow& row) override {
        JpegDecoder decoder(file_);
        TESSERA_TRY(start(decoder));
        if (!decoder.start_rows())
            return decoder.error();
        const bool is_cmyk = decoder.codec.out_color_space == JCS_CMYK;
        std::vector<std::byte> bytes(std::size_t{shape_.width} * (is_cmyk ? 4 : shape_.channels));
        for (std::uint32_t y = 0; y < last; ++y) {
            if (!decoder.read_row(bytes.data()))
                return decoder.error();
            if (is_cmyk)
                cmyk_to_rgb(bytes, decoder.codec.saw_Adobe_marker != 0);
            row(y, std::span(bytes).first(std::size_t{shape_.width} * shape_.channels));
        }
        return {};
    }

    // In place. Adobe's programs, which write most CMYK files, store inverted values.
    static void cmyk_to_rgb(std::span<std::byte> row, bool is_inverted) {
        const unsigned flip = is_inverted ? 0 : 255;
        for (std::size_t x = 0; x < row.size() / 4; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                row[3 * x + c] =
                    static_cast<std::byte>(((std::to_integer<unsigned>(row[4 * x + c]) ^ flip) *
                                                (std::to_integer<unsigned>(row[4 * x + 3]) ^ flip) +
                                            127) /
                                           255);
    }

    ByteSource& file_;
    Orientation orientation_ = Orientation::top_left;
};

} // namespace

Result<std::unique_ptr<PictureReader>> open_jpeg(ByteSource& file, Exif exif) {
    auto reader = std::make_unique<JpegReader>(file);
    TESSERA_TRY(reader->open());
    const Orientation orientation =
        exif == Exif::followed ? reader->orientation() : Orientation::top_left;
    return turned(std::move(reader), orientation);
}

} // namespace tessera::corpus
