// TIFF by libtiff: integers of 8 and 16 bits and floats as they are, other kinds as libtiff shows
// them.
#include "corpus/exr_samples.h"
#include "corpus/picture/exif.h"
#include "corpus/picture/icc.h"
#include "corpus/picture/picture_readers.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <tiffio.h>

namespace tessera::corpus {
namespace {

constexpr tmsize_t most_allocation = tmsize_t{1} << 29; // of libtiff at once, bytes
constexpr std::uint64_t most_block_bytes = 1u << 29;    // of a strip or tile
constexpr std::uint16_t most_samples = 16;              // of a pixel

// libtiff's view of a file. It reports errors as text.
class TiffFile {
public:
    explicit TiffFile(ByteSource& file) : file_(file) {
        TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
        if (options == nullptr)
            return;
        TIFFOpenOptionsSetMaxSingleMemAlloc(options, most_allocation);
        TIFFOpenOptionsSetErrorHandlerExtR(options, on_error, this);
        TIFFOpenOptionsSetWarningHandlerExtR(
            options, [](TIFF*, void*, const char*, const char*, va_list) { return 1; }, nullptr);
        tiff = TIFFClientOpenExt(file.name().c_str(), "rm", this, read, no_write, seek, close, size,
                                 nullptr, nullptr, options);
        TIFFOpenOptionsFree(options);
    }
    TiffFile(const TiffFile&) = delete;
    TiffFile& operator=(const TiffFile&) = delete;
    ~TiffFile() {
        if (tiff != nullptr)
            TIFFClose(tiff);
    }
    Status error() const { return status_.ok() ? damaged(std::string("TIFF: ") + text_) : status_; }
    template <class Value> Value field(ttag_t tag, Value otherwise) const {
        Value value = otherwise;
        return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : otherwise;
    }

    TIFF* tiff = nullptr;

private:
    static TiffFile& of(thandle_t handle) { return *static_cast<TiffFile*>(handle); }
    static int on_error(TIFF*, void* data, const char*, const char* format, va_list values) {
        auto* self = static_cast<TiffFile*>(data);
        if (self->text_[0] == '\0') // the first says why
            std::vsnprintf(self->text_, sizeof self->text_, format, values);
        return 1;
    }
    static tmsize_t read(thandle_t handle, void* out, tmsize_t count) {
        TiffFile& self = of(handle);
        const std::uint64_t size = self.file_.size();
        const auto bytes =
            std::min(static_cast<std::uint64_t>(count), size - std::min(size, self.position_));
        if (bytes == 0) // libtiff reports that the file ends
            return 0;
        self.status_ = self.file_.read(self.position_, {static_cast<std::byte*>(out), bytes});
        self.position_ += bytes;
        return self.status_.ok() ? static_cast<tmsize_t>(bytes) : -1;
    }
    static tmsize_t no_write(thandle_t, void*, tmsize_t) { return -1; }
    static toff_t seek(thandle_t handle, toff_t offset, int whence) {
        TiffFile& self = of(handle);
        self.position_ = offset + (whence == SEEK_CUR   ? self.position_
                                   : whence == SEEK_END ? self.file_.size()
                                                        : 0);
        return self.position_;
    }
    static int close(thandle_t) { return 0; }
    static toff_t size(thandle_t handle) { return of(handle).file_.size(); }

    ByteSource& file_;
    std::uint64_t position_ = 0;
    Status status_; // of the last read
    char text_[200] = "";
};

// What the first picture of a file holds.
struct TiffLayout {
    std::uint16_t bits = 1, samples = 1, format = SAMPLEFORMAT_UINT, photometric = 0;
    std::uint16_t planar = PLANARCONFIG_CONTIG;
    std::uint16_t colours = 1; // samples of a pixel that are colours
    bool has_alpha = false, is_tiled = false;
    std::uint32_t width = 0, height = 0;
    std::uint32_t block_width = 0, block_height = 0; // of a strip or tile

    bool is_float() const { return format == SAMPLEFORMAT_IEEEFP; }
    // Whether we read the samples as they are; else libtiff makes 8-bit colours of them.
    bool is_plain() const {
        const bool is_grey = photometric == PHOTOMETRIC_MINISBLACK ||
                             (photometric == PHOTOMETRIC_MINISWHITE && !is_float());
        if (samples > most_samples || samples < colours ||
            !(is_grey || photometric == PHOTOMETRIC_RGB))
            return false;
        return is_float() ? bits == 16 || bits == 32 || bits == 64
                          : format == SAMPLEFORMAT_UINT && (bits == 8 || bits == 16 || bits == 32);
    }
    std::uint16_t channels() const { return static_cast<std::uint16_t>(colours + has_alpha); }
};

TiffLayout layout_of(const TiffFile& file) {
    TiffLayout l;
    l.width = file.field<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
    l.height = file.field<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0);
    l.bits = file.field<std::uint16_t>(TIFFTAG_BITSPERSAMPLE, 1);
    l.samples = file.field<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL, 1);
    l.format = file.field<std::uint16_t>(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    l.planar = file.field<std::uint16_t>(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    l.photometric = file.field<std::uint16_t>(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    l.colours = l.photometric == PHOTOMETRIC_RGB ? 3 : 1;
    std::uint16_t extra = 0, *kinds = nullptr;
    if (TIFFGetFieldDefaulted(file.tiff, TIFFTAG_EXTRASAMPLES, &extra, &kinds) == 1 && extra > 0 &&
        kinds != nullptr)
        l.has_alpha = l.samples > l.colours &&
                      (kinds[0] == EXTRASAMPLE_ASSOCALPHA || kinds[0] == EXTRASAMPLE_UNASSALPHA);
    l.is_tiled = TIFFIsTiled(file.tiff) != 0;
    l.block_width = l.is_tiled ? file.field<std::uint32_t>(TIFFTAG_TILEWIDTH, 0) : l.width;
    l.block_height = l.is_tiled
                         ? file.field<std::uint32_t>(TIFFTAG_TILELENGTH, 0)
                         : std::min(file.field<std::uint32_t>(TIFFTAG_ROWSPERSTRIP, 0), l.height);
    return l;
}

// Reads strips or tiles, and takes the channels out of the samples.
class BlockReader {
public:
    BlockReader(const TiffFile& file, const TiffLayout& layout, HeldPicture& picture)
        : file_(file), l_(layout), picture_(picture) {}

    Status read() {
        const std::uint64_t pixel =
            l_.bits / 8u * (l_.planar == PLANARCONFIG_CONTIG ? l_.samples : 1u);
        if (l_.block_width == 0 || l_.block_height == 0 ||
            l_.block_width > most_block_bytes / l_.block_height / pixel)
            return not_supported("a TIFF with blocks of " + std::to_string(l_.block_width) + "x" +
                                 std::to_string(l_.block_height) + " pixels");
        const auto bytes = static_cast<std::uint64_t>(l_.is_tiled ? TIFFTileSize(file_.tiff)
                                                                  : TIFFStripSize(file_.tiff));
        if (bytes != pixel * l_.block_width * l_.block_height)
            return damaged("TIFF: the size of its strips or tiles");
        block_.resize(bytes);
        const std::uint16_t planes = l_.planar == PLANARCONFIG_CONTIG ? 1 : l_.channels();
        for (std::uint32_t y = 0; y < l_.height; y += l_.block_height) {
            grow(std::min(l_.height, y + l_.block_height));
            for (std::uint32_t x = 0; x < l_.width; x += l_.block_width)
                for (std::uint16_t plane = 0; plane < planes; ++plane)
                    TESSERA_TRY(read_block(x, y, plane));
        }
        return {};
    }

private:
    // Memory follows what was read, not what the header claims.
    void grow(std::uint32_t rows) {
        const std::size_t samples = std::size_t{rows} * l_.width * l_.channels();
        if (l_.is_float())
            picture_.floats.resize(samples);
        else
            picture_.integers.resize(samples * picture_.shape.bits / 8);
    }

    Status read_block(std::uint32_t x, std::uint32_t y, std::uint16_t plane) {
        const std::uint32_t rows = std::min(l_.block_height, l_.height - y);
        const std::size_t samples = l_.planar == PLANARCONFIG_CONTIG ? l_.samples : 1;
        const std::size_t line = l_.block_width * samples * l_.bits / 8;
        const auto needed = static_cast<tmsize_t>(l_.is_tiled ? block_.size() : line * rows);
        const tmsize_t got =
            l_.is_tiled
                ? TIFFReadEncodedTile(file_.tiff, TIFFComputeTile(file_.tiff, x, y, 0, plane),
                                      block_.data(), needed)
                : TIFFReadEncodedStrip(file_.tiff, TIFFComputeStrip(file_.tiff, y, plane),
                                       block_.data(), needed);
        if (got != needed)
            return file_.error();
        const std::uint32_t columns = std::min(l_.block_width, l_.width - x);
        const std::size_t taken = samples == 1 ? 1 : l_.channels();
        for (std::uint32_t row = 0; row < rows; ++row)
            for (std::uint32_t column = 0; column < columns; ++column)
                for (std::size_t c = 0; c < taken; ++c)
                    take(&block_[row * line + (column * samples + c) * l_.bits / 8],
                         (std::size_t{y + row} * l_.width + x + column) * l_.channels() + plane +
                             c);
        return {};
    }

    template <class Number> static Number load(const std::byte* from) {
        Number number;
        std::memcpy(&number, from, sizeof number);
        return number;
    }

    void take(const std::byte* from, std::size_t to) {
        if (l_.is_float()) {
            picture_.floats[to] = l_.bits == 16   ? half_to_float(load<std::uint16_t>(from))
                                  : l_.bits == 32 ? load<float>(from)
                                                  : static_cast<float>(load<double>(from));
            return;
        }
        // White is 0 in some scans.
        const std::uint16_t flip = l_.photometric == PHOTOMETRIC_MINISWHITE ? 0xffff : 0;
        if (l_.bits == 8) {
            picture_.integers[to] = *from ^ static_cast<std::byte>(flip & 0xff);
            return;
        }
        const auto value = static_cast<std::uint16_t>(
            (l_.bits == 16 ? load<std::uint16_t>(from) : load<std::uint32_t>(from) >> 16) ^ flip);
        std::memcpy(&picture_.integers[2 * to], &value, 2);
    }

    const TiffFile& file_;
    const TiffLayout& l_;
    HeldPicture& picture_;
    std::vector<std::byte> block_;
};

// Palettes, fewer than 8 bits, CMYK, YCbCr, Lab and so on, as 8-bit colours.
Status read_as_shown(const TiffFile& file, const TiffLayout& layout, Orientation orientation,
                     HeldPicture& picture) {
    char why[1024] = "";
    if (TIFFRGBAImageOK(file.tiff, why) == 0)
        return not_supported(std::string("this TIFF (") + why + ")");
    const bool is_grey = layout.colours == 1 && (layout.photometric == PHOTOMETRIC_MINISBLACK ||
                                                 layout.photometric == PHOTOMETRIC_MINISWHITE);
    picture.shape.channels = is_grey ? 1 : 3;
    picture.shape.bits = 8;
    picture.shape.is_float = false;
    std::vector<std::uint32_t> raster(std::size_t{layout.width} * layout.height);
    if (TIFFReadRGBAImageOriented(file.tiff, layout.width, layout.height, raster.data(),
                                  static_cast<int>(orientation), 1) == 0)
        return file.error();
    picture.integers.reserve(raster.size() * picture.shape.channels);
    for (const std::uint32_t pixel : raster)
        for (unsigned c = 0; c < picture.shape.channels; ++c)
            picture.integers.push_back(static_cast<std::byte>(pixel >> 8 * c & 255));
    return {};
}

} // namespace

Result<std::unique_ptr<PictureReader>> open_tiff(ByteSource& source, Exif exif) {
    const TiffFile file(source);
    if (file.tiff == nullptr)
        return file.error();
    const TiffLayout layout = layout_of(file);
    TESSERA_TRY(check_size(layout.width, layout.height));
    const auto stated = file.field<std::uint16_t>(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    const auto orientation =
        stated >= 1 && stated <= 8 ? static_cast<Orientation>(stated) : Orientation::top_left;
    HeldPicture picture;
    picture.shape = {.kind = PictureKind::tiff,
                     .width = layout.width,
                     .height = layout.height,
                     .channels = static_cast<std::uint8_t>(layout.channels()),
                     .bits = static_cast<std::uint8_t>(layout.bits == 8 ? 8 : 16),
                     .is_float = layout.is_float()};
    TESSERA_TRY(layout.is_plain() ? BlockReader(file, layout, picture).read()
                                  : read_as_shown(file, layout, orientation, picture));
    if (TIFFLastDirectory(file.tiff) == 0)
        picture.notes.emplace_back("only the first picture of a TIFF is read");
    if (layout.is_plain() && layout.samples > layout.channels())
        picture.notes.emplace_back("channels that are neither colour nor alpha are left out");
    std::uint32_t length = 0;
    void* profile = nullptr;
    if (TIFFGetField(file.tiff, TIFFTAG_ICCPROFILE, &length, &profile) == 1)
        if (std::string note = icc_note({static_cast<std::byte*>(profile), length}); !note.empty())
            picture.notes.push_back(std::move(note));
    return turned(held(std::move(picture)),
                  exif == Exif::followed ? orientation : Orientation::top_left);
}

} // namespace tessera::corpus
