#include "corpus/picture_file.h"

#include "corpus/picture/exr_reader.h"
#include "corpus/picture/picture_readers.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

constexpr std::uint64_t most_light_bytes = 1u << 30; // of a file

struct Signature {
    std::string_view bytes;
    PictureKind kind;
};
using namespace std::string_view_literals;
constexpr Signature signatures[] = {{"\x89PNG\r\n\x1a\n"sv, PictureKind::png},
                                    {"\xff\xd8\xff"sv, PictureKind::jpeg},
                                    {"\x76\x2f\x31\x01\x02"sv, PictureKind::exr}, // and its version
                                    {"#?RADIANCE"sv, PictureKind::hdr},
                                    {"#?RGBE"sv, PictureKind::hdr},
                                    {"BM"sv, PictureKind::bmp}};

constexpr std::pair<std::string_view, const char*> unsupported_kinds[] = {
    {"GIF8"sv, "a GIF"},   {"8BPS"sv, "a PSD"},    {"\x53\x80\xf6\x34"sv, "a Softimage PIC"},
    {"P5"sv, "a PNM"},     {"P6"sv, "a PNM"},      {"II*\0"sv, "a TIFF"},
    {"MM\0*"sv, "a TIFF"}, {"\xabKTX"sv, "a KTX"}, {"DDS "sv, "a DDS"}};

PictureKind kind_of(std::string_view begin) {
    for (const auto& [bytes, kind] : signatures)
        if (begin.starts_with(bytes))
            return kind;
    return begin.starts_with("RIFF") &&
                   begin.substr(std::min<std::size_t>(8, begin.size())).starts_with("WEBP")
               ? PictureKind::webp
               : PictureKind::none;
}

Result<std::unique_ptr<PictureReader>> open_exr(ByteSource& file, unsigned threads) {
    auto reader = std::make_unique<ExrReader>(file, threads);
    TESSERA_TRY(reader->open());
    if (reader->parts() != 1)
        return Status(ErrorCode::unsupported, "a picture of " + std::to_string(reader->parts()) +
                                                  " parts; only one is read");
    return std::unique_ptr<PictureReader>(std::move(reader));
}

// ", but a Git LFS pointer" and the like; empty where the kind of the file is not known.
std::string but_of(ByteSource& file) {
    std::array<std::byte, 64> begin{};
    const auto read = std::span(begin).first(std::min<std::uint64_t>(begin.size(), file.size()));
    const std::string kind = file.read(0, read).ok() ? known_kind(read) : std::string();
    return kind.empty() ? kind : ", but " + kind;
}

Result<std::unique_ptr<PictureReader>> open_by_kind(ByteSource& file, unsigned threads, Exif exif) {
    switch (picture_kind_of(file)) {
    case PictureKind::png:
        return open_png(file);
    case PictureKind::jpeg:
        return open_jpeg(file, exif);
    case PictureKind::exr:
        return open_exr(file, threads);
    default:
        return Status(ErrorCode::invalid_file, "not a PNG, JPEG or EXR picture" + but_of(file));
    }
}

Result<Image> read_rgba(Result<std::unique_ptr<PictureReader>> opened) {
    TESSERA_TRY_ASSIGN(const auto reader, std::move(opened));
    const PictureShape& shape = reader->shape();
    TESSERA_TRY(check_size(shape.width, shape.height));
    Image image{shape.width, shape.height, {}};
    image.texels.resize(std::size_t{shape.width} * shape.height);
    const std::size_t n = shape.channels, colours = n < 3 ? 1 : 3;
    TESSERA_TRY(reader->read_rows(
        SampleType::unorm8, 0, shape.height, [&](std::uint32_t y, std::span<const std::byte> row) {
            for (std::size_t x = 0; x < shape.width; ++x) {
                auto& texel = image.texels[std::size_t{y} * shape.width + x];
                for (std::size_t c = 0; c < 3; ++c)
                    texel[c] = std::to_integer<std::uint8_t>(row[x * n + std::min(c, colours - 1)]);
                texel[3] = n == colours ? 255 : std::to_integer<std::uint8_t>(row[x * n + colours]);
            }
        }));
    return image;
}

// Values above 1 become white.
Image to_srgb(const LightImage& light) {
    Image image{light.width, light.height, {}};
    for (const glm::vec3& texel : light.texels) {
        const auto code = [](float linear) {
            const float x = std::min(linear, 1.0f);
            const float y = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
            return static_cast<std::uint8_t>(255 * y + 0.5f);
        };
        image.texels.push_back({code(texel.x), code(texel.y), code(texel.z), 255});
    }
    return image;
}

Result<LightImage> read_light(ByteSource& file) {
    const PictureKind kind = picture_kind_of(file);
    if (kind == PictureKind::exr) {
        ExrReader reader(file, 0);
        TESSERA_TRY(reader.open());
        TESSERA_TRY(check_size(reader.shape().width, reader.shape().height));
        LightImage image;
        TESSERA_TRY(reader.read_light(image));
        return image;
    }
    if (kind != PictureKind::hdr)
        return Status(ErrorCode::invalid_file, "not an .hdr or .exr picture");
    if (file.size() > most_light_bytes)
        return Status(ErrorCode::unsupported,
                      "more than " + std::to_string(most_light_bytes) + " bytes");
    std::vector<std::byte> bytes(file.size());
    TESSERA_TRY(file.read(0, bytes));
    return read_hdr(bytes);
}

} // namespace

PictureKind picture_kind_of(ByteSource& file) {
    char begin[12];
    const std::size_t length = std::min<std::uint64_t>(sizeof begin, file.size());
    const Status read = file.read(0, std::as_writable_bytes(std::span(begin, length)));
    return read.ok() ? kind_of({begin, length}) : PictureKind::none;
}

Result<std::unique_ptr<PictureReader>> open_picture_file(ByteSource& file, unsigned threads,
                                                         Exif exif) {
    auto reader = open_by_kind(file, threads, exif);
    if (!reader.ok())
        return named(reader.status(), file.name());
    (*reader)->name_ = file.name();
    return reader;
}

Result<Image> decode_image(std::span<const unsigned char> file) {
    const auto bytes = std::as_bytes(file);
    const std::string_view begin(reinterpret_cast<const char*>(file.data()), file.size());
    const auto source = wrap_memory(bytes);
    switch (kind_of(begin)) {
    case PictureKind::png:
        return read_rgba(open_png(*source));
    case PictureKind::jpeg:
        return read_rgba(open_jpeg(*source, Exif::followed));
    case PictureKind::webp:
        return read_webp(bytes);
    case PictureKind::bmp:
        return read_bmp(bytes);
    case PictureKind::hdr: {
        TESSERA_TRY_ASSIGN(const LightImage light, read_hdr(bytes));
        return to_srgb(light);
    }
    case PictureKind::exr:
        return not_supported("an EXR as a texture");
    case PictureKind::none:
        break;
    }
    for (const auto& [signature, name] : unsupported_kinds)
        if (begin.starts_with(signature))
            return not_supported(name);
    if (const std::string kind = known_kind(bytes); !kind.empty())
        return Status(ErrorCode::invalid_file, "not a picture, but " + kind);
    return read_tga(bytes);
}

Result<LightImage> read_light_image(ByteSource& file) {
    auto image = read_light(file);
    return image.ok() ? std::move(image) : named(image.status(), file.name());
}

Status PictureReader::read_rows(SampleType type, std::uint32_t first, std::uint32_t last,
                                const PictureRow& row) {
    const Status status = read(type, first, last, row);
    return name_.empty() ? status : named(status, name_);
}

} // namespace tessera::corpus
