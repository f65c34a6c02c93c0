#include "tools/picture/jpeg_file.h"

#include "tools/support/interrupt.h"

#include <array>
#include <csetjmp>
#include <cstdio> // before jpeglib.h, which needs it
#include <cstdlib>
#include <cstring>
#include <jerror.h>
#include <jpeglib.h>
#include <string>

namespace tessera {
namespace {

constexpr std::size_t jpeg_buffer_bytes = 1 << 16;
constexpr std::uint64_t jpeg_end_bytes = 1 << 16; // in which a JPEG has its end
// Coefficients of a progressive picture are held whole.
constexpr std::uint64_t max_progressive_bytes = 1ull << 30;
constexpr int most_scans = 500; // more are an attack on time

// libjpeg reports through a long jump, so the functions that it may leave own nothing.
struct JpegFailure {
    jpeg_error_mgr manager; // first: libjpeg knows this part only
    std::jmp_buf jump;
    char text[JMSG_LENGTH_MAX] = "";
};

[[noreturn]] void fail_jpeg(j_common_ptr codec) {
    auto* failure = reinterpret_cast<JpegFailure*>(codec->err);
    (*codec->err->format_message)(codec, failure->text);
    std::longjmp(failure->jump, 1);
}

// Warnings are damage, but for those about what does not touch the pixels.
void on_jpeg_message(j_common_ptr codec, int level) {
    const int code = codec->err->msg_code;
    if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_ADOBE_XFORM &&
        code != JWRN_JFIF_MAJOR)
        fail_jpeg(codec);
}

void set_up(JpegFailure& failure) {
    jpeg_std_error(&failure.manager);
    failure.manager.error_exit = fail_jpeg;
    failure.manager.emit_message = on_jpeg_message;
}

struct JpegReader {
    explicit JpegReader(ByteSource& bytes) : file(bytes) {
        set_up(failure);
        codec.err = &failure.manager;
    }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;
    ~JpegReader() { jpeg_destroy_decompress(&codec); }
    // Why libjpeg gave up: the medium, or the picture.
    Status error() const {
        return !status.ok() ? status
                            : Status(ErrorCode::invalid_file,
                                     file.name() + ": damaged JPEG: " + failure.text);
    }

    jpeg_decompress_struct codec{};
    JpegFailure failure;
    jpeg_source_mgr source{};
    jpeg_progress_mgr progress{};
    ByteSource& file;
    std::uint64_t position = 0;
    Status status; // of the last read
    std::array<JOCTET, jpeg_buffer_bytes> buffer{};
};

bool fill(JpegReader& r) {
    const std::uint64_t count =
        std::min<std::uint64_t>(r.buffer.size(), r.file.size() - r.position);
    if (count == 0)
        return false;
    r.status = r.file.read(r.position, std::as_writable_bytes(std::span(r.buffer).first(count)));
    r.position += count;
    r.source.next_input_byte = r.buffer.data();
    r.source.bytes_in_buffer = count;
    return r.status.ok();
}

boolean fill_input(j_decompress_ptr codec) {
    if (!fill(*static_cast<JpegReader*>(codec->client_data)))
        ERREXIT(codec, JERR_INPUT_EOF);
    return TRUE;
}

void skip_input(j_decompress_ptr codec, long count) {
    while (count > static_cast<long>(codec->src->bytes_in_buffer)) {
        count -= static_cast<long>(codec->src->bytes_in_buffer);
        fill_input(codec);
    }
    if (count <= 0)
        return;
    codec->src->next_input_byte += count;
    codec->src->bytes_in_buffer -= static_cast<std::size_t>(count);
}

void watch_scans(j_common_ptr codec) {
    auto* reader = static_cast<JpegReader*>(codec->client_data);
    if (reader->codec.input_scan_number > most_scans)
        ERREXIT(codec, JERR_BAD_PROGRESSION);
    reader->status = check_interrupt();
    if (!reader->status.ok())
        ERREXIT(codec, JERR_INPUT_EOF);
}

bool start_jpeg(JpegReader& r) {
    if (setjmp(r.failure.jump))
        return false;
    jpeg_create_decompress(&r.codec);
    r.codec.client_data = &r;
    r.source.init_source = [](j_decompress_ptr) {};
    r.source.term_source = [](j_decompress_ptr) {};
    r.source.fill_input_buffer = fill_input;
    r.source.skip_input_data = skip_input;
    r.source.resync_to_restart = jpeg_resync_to_restart;
    r.codec.src = &r.source;
    r.progress.progress_monitor = watch_scans;
    r.codec.progress = &r.progress;
    jpeg_read_header(&r.codec, TRUE);
    r.codec.out_color_space = r.codec.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
    r.codec.dct_method = JDCT_ISLOW; // the same texels on every machine
    return true;
}

bool start_rows(JpegReader& r) {
    if (setjmp(r.failure.jump))
        return false;
    return jpeg_start_decompress(&r.codec) == TRUE;
}

bool read_jpeg_row(JpegReader& r, std::byte* row) {
    if (setjmp(r.failure.jump))
        return false;
    auto* line = reinterpret_cast<JSAMPROW>(row);
    return jpeg_read_scanlines(&r.codec, &line, 1) == 1;
}

Status check_jpeg(JpegReader& r) {
    const auto& codec = r.codec;
    if (codec.num_components != 1 && codec.num_components != 3)
        return {ErrorCode::unsupported, r.file.name() + ": a JPEG of " +
                                            std::to_string(codec.num_components) +
                                            " channels (CMYK?); views are grey or RGB"};
    const std::uint64_t held = std::uint64_t{codec.image_width} * codec.image_height *
                               static_cast<std::uint64_t>(codec.num_components) * sizeof(JCOEF);
    if (jpeg_has_multiple_scans(&r.codec) && held > max_progressive_bytes)
        return {ErrorCode::unsupported, r.file.name() + ": a progressive JPEG, and too large"};
    return {};
}

struct JpegWriter {
    JpegWriter() {
        set_up(failure);
        codec.err = &failure.manager;
    }
    JpegWriter(const JpegWriter&) = delete;
    JpegWriter& operator=(const JpegWriter&) = delete;
    ~JpegWriter() {
        jpeg_destroy_compress(&codec);
        std::free(bytes);
    }
    jpeg_compress_struct codec{};
    JpegFailure failure;
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
};

bool write_jpeg(JpegWriter& w, const JpegShape& shape, const std::byte* pixels, int quality) {
    if (setjmp(w.failure.jump))
        return false;
    jpeg_create_compress(&w.codec);
    jpeg_mem_dest(&w.codec, &w.bytes, &w.size);
    w.codec.image_width = shape.width;
    w.codec.image_height = shape.height;
    w.codec.input_components = shape.channels;
    w.codec.in_color_space = shape.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&w.codec);
    jpeg_set_quality(&w.codec, quality, TRUE);
    w.codec.comp_info[0].h_samp_factor = w.codec.comp_info[0].v_samp_factor = 1;
    w.codec.dct_method = JDCT_ISLOW;
    jpeg_start_compress(&w.codec, TRUE);
    for (std::uint32_t y = 0; y < shape.height; ++y) {
        auto* row =
            reinterpret_cast<JSAMPROW>(const_cast<std::byte*>(pixels + y * shape.row_bytes()));
        jpeg_write_scanlines(&w.codec, &row, 1);
    }
    jpeg_finish_compress(&w.codec);
    return true;
}

} // namespace

Result<JpegShape> read_jpeg_shape(ByteSource& file) {
    JpegReader r(file);
    if (!start_jpeg(r))
        return r.error();
    TESSERA_TRY(check_jpeg(r));
    std::string tail(std::min(file.size(), jpeg_end_bytes), '\0');
    TESSERA_TRY(file.read(file.size() - tail.size(), std::as_writable_bytes(std::span(tail))));
    if (tail.find("\xff\xd9") == std::string::npos)
        return Status(ErrorCode::invalid_file, file.name() + ": damaged JPEG: it ends too early");
    return JpegShape{r.codec.image_width, r.codec.image_height,
                     static_cast<std::uint8_t>(r.codec.num_components)};
}

Status read_jpeg(ByteSource& file, const JpegShape& shape, std::uint32_t rows,
                 const std::function<void(std::uint32_t, std::span<const std::byte>)>& row) {
    JpegReader r(file);
    if (!start_jpeg(r))
        return r.error();
    TESSERA_TRY(check_jpeg(r));
    if (JpegShape{r.codec.image_width, r.codec.image_height,
                  static_cast<std::uint8_t>(r.codec.num_components)} != shape)
        return {ErrorCode::invalid_file, file.name() + ": changed while it was read"};
    if (!start_rows(r))
        return r.error();
    std::vector<std::byte> bytes(shape.row_bytes());
    for (std::uint32_t y = 0; y < rows; ++y) {
        if (!read_jpeg_row(r, bytes.data()))
            return r.error();
        row(y, bytes);
    }
    return {};
}

Result<std::vector<std::byte>> encode_jpeg(const JpegShape& shape,
                                           std::span<const std::byte> pixels, int quality) {
    if ((shape.channels != 1 && shape.channels != 3) || quality < 1 || quality > 100 ||
        pixels.size() != shape.row_bytes() * shape.height)
        return Status(ErrorCode::bad_argument, "the pixels do not fit a JPEG picture");
    if (shape.width > JPEG_MAX_DIMENSION || shape.height > JPEG_MAX_DIMENSION)
        return Status(ErrorCode::unsupported, "a JPEG picture has sides of at most " +
                                                  std::to_string(JPEG_MAX_DIMENSION) + " pixels");
    JpegWriter w;
    if (!write_jpeg(w, shape, pixels.data(), quality)) {
        // libjpeg says where its memory is at the end only, and may have moved it.
        w.bytes = nullptr;
        return Status(ErrorCode::runtime, std::string("JPEG: ") + w.failure.text);
    }
    const auto* bytes = reinterpret_cast<const std::byte*>(w.bytes);
    return std::vector<std::byte>(bytes, bytes + w.size);
}

} // namespace tessera
