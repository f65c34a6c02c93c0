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
                                    {"BM"sv, PictureKind::bmp},
                                    {"II*\0"sv, PictureKind::tiff},
                                    {"MM\0*"sv, PictureKind::tiff},
                                    {"II+\0"sv, PictureKind::tiff}, // of 64 bits
                                    {"MM\0+"sv, PictureKind::tiff}};

constexpr std::pair<std::string_view, const char*> unsupported_kinds[] = {
    {"GIF8"sv, "a GIF"},
    {"8BPS"sv, "a PSD"},
    {"\x53\x80\xf6\x34"sv, "a Softimage PIC"},
    {"\xabKTX"sv, "a KTX"},
    {"DDS "sv, "a DDS"},
    {"P1"sv, "a PBM"},
    {"P4"sv, "a PBM"},
    {"P7"sv, "a PAM"},
    {"\0\0\0\x0cjP  "sv, "a JPEG 2000"},
    {"\xff\x0a"sv, "a JPEG XL"},
    {"\0\0\0\x0cJXL "sv, "a JPEG XL"}};

// HEIC and AVIF are boxes with a name behind four bytes of length.
const char* unsupported_kind(std::string_view begin) {
    for (const auto& [signature, name] : unsupported_kinds)
        if (begin.starts_with(signature))
            return name;
    const std::string_view box = begin.substr(std::min<std::size_t>(4, begin.size()), 8);
    return box == "ftypavif"                        ? "an AVIF"
           : box == "ftypheic" || box == "ftypmif1" ? "a HEIC"
                                                    : nullptr;
}

PictureKind kind_of(std::string_view begin) {
    for (const auto& [bytes, kind] : signatures)
        if (begin.starts_with(bytes))
            return kind;
    // A letter, a number or F, and a blank.
    if (begin.size() > 2 && begin[0] == 'P' &&
        (begin[2] == '#' || (begin[2] >= '\t' && begin[2] <= ' ')))
        return begin[1] == 'F' || begin[1] == 'f'                  ? PictureKind::pfm
               : "2356"sv.find(begin[1]) != std::string_view::npos ? PictureKind::pnm
                                                                   : PictureKind::none;
    return begin.starts_with("RIFF") &&
                   begin.substr(std::min<std::size_t>(8, begin.size())).starts_with("WEBP")
               ? PictureKind::webp
               : PictureKind::none;
}

// Other kinds of files that are named .tga by mistake are not.
bool is_tga(ByteSource& file, std::string_view begin) {
    constexpr std::string_view footer = "TRUEVISION-XFILE.\0"sv;
    std::array<char, footer.size()> end{};
    if (file.size() < footer.size() || unsupported_kind(begin))
        return false;
    if (file.read(file.size() - footer.size(), std::as_writable_bytes(std::span(end))).ok() &&
        std::string_view(end.data(), end.size()) == footer)
        return true;
    const std::string& name = file.name();
    const std::string_view ending =
        std::string_view(name).substr(name.size() - std::min<std::size_t>(name.size(), 4));
    const auto source = std::as_bytes(std::span(begin));
    return (ending == ".tga" || ending == ".TGA") && known_kind(source).empty();
}

Result<std::unique_ptr<PictureReader>> open_exr(ByteSource& file, const PictureOptions& options) {
    auto reader = std::make_unique<ExrReader>(file, options.threads);
    TESSERA_TRY(reader->open(options.layer));
    return std::unique_ptr<PictureReader>(std::move(reader));
}

// What a file is that is no picture of ours.
Status not_a_picture(ByteSource& file, const std::string& wanted) {
    std::array<std::byte, 64> begin{};
    const auto read = std::span(begin).first(std::min<std::uint64_t>(begin.size(), file.size()));
    TESSERA_TRY(file.read(0, read));
    const std::string_view text(reinterpret_cast<const char*>(read.data()), read.size());
    if (const char* kind = unsupported_kind(text))
        return not_supported(kind);
    const std::string kind = known_kind(read);
    return {ErrorCode::invalid_file, "not " + wanted + (kind.empty() ? "" : ", but " + kind)};
}

Result<std::vector<std::byte>> read_whole(ByteSource& file) {
    if (file.size() > most_light_bytes)
        return Status(ErrorCode::unsupported,
                      "more than " + std::to_string(most_light_bytes) + " bytes");
    std::vector<std::byte> bytes(file.size());
    TESSERA_TRY(file.read(0, bytes));
    return bytes;
}

// Without alpha where there is none.
Result<HeldPicture> held_image(Result<Image> image, PictureKind kind) {
    if (!image.ok())
        return image.status();
    const bool is_opaque =
        std::ranges::all_of(image->texels, [](const auto& texel) { return texel[3] == 255; });
    const std::size_t channels = is_opaque ? 3 : 4;
    HeldPicture picture;
    picture.shape = {.kind = kind,
                     .width = image->width,
                     .height = image->height,
                     .channels = static_cast<std::uint8_t>(channels)};
    picture.integers.reserve(image->texels.size() * channels);
    for (const auto& texel : image->texels)
        for (std::size_t c = 0; c < channels; ++c)
            picture.integers.push_back(std::byte{texel[c]});
    return picture;
}

Result<HeldPicture> held_light(Result<LightImage> light) {
    if (!light.ok())
        return light.status();
    HeldPicture picture;
    picture.shape = {.kind = PictureKind::hdr,
                     .width = light->width,
                     .height = light->height,
                     .channels = 3,
                     .bits = 16,
                     .is_float = true};
    for (const glm::vec3& texel : light->texels)
        picture.floats.insert(picture.floats.end(), {texel.x, texel.y, texel.z});
    return picture;
}

Result<HeldPicture> read_held(PictureKind kind, std::span<const std::byte> file) {
    switch (kind) {
    case PictureKind::pnm:
        return read_pnm(file);
    case PictureKind::pfm:
        return read_pfm(file);
    case PictureKind::webp:
        return held_image(read_webp(file), kind);
    case PictureKind::bmp:
        return held_image(read_bmp(file), kind);
    case PictureKind::tga:
        return held_image(read_tga(file), kind);
    default:
        return held_light(read_hdr(file));
    }
}

Result<std::unique_ptr<PictureReader>> open_by_kind(ByteSource& file,
                                                    const PictureOptions& options) {
    const PictureKind kind = picture_kind_of(file);
    if (kind != PictureKind::exr && !options.layer.empty())
        return Status(ErrorCode::bad_argument, "only EXR pictures have layers, such as '" +
                                                   options.layer.substr(0, 60) + "'");
    switch (kind) {
    case PictureKind::png:
        return open_png(file);
    case PictureKind::jpeg:
        return open_jpeg(file, options.exif);
    case PictureKind::exr:
        return open_exr(file, options);
    case PictureKind::tiff:
        return open_tiff(file, options.exif);
    case PictureKind::none:
        return not_a_picture(file, "a PNG, JPEG, EXR, TIFF, WebP, PPM or other known picture");
    default:
        break;
    }
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole(file));
    TESSERA_TRY_ASSIGN(HeldPicture picture, read_held(kind, bytes));
    return held(std::move(picture));
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
            const float x = linear > 0 ? std::min(linear, 1.0f) : 0; // also for NaN
            const float y = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
            return static_cast<std::uint8_t>(255 * y + 0.5f);
        };
        image.texels.push_back({code(texel.x), code(texel.y), code(texel.z), 255});
    }
    return image;
}

// Grey becomes three channels.
LightImage light_of(const HeldPicture& picture) {
    LightImage image{picture.shape.width, picture.shape.height, {}};
    const std::size_t channels = picture.shape.channels;
    for (std::size_t i = 0; i < picture.floats.size(); i += channels)
        image.texels.emplace_back(picture.floats[i], picture.floats[i + channels / 2],
                                  picture.floats[i + channels - 1]);
    return image;
}

Result<LightImage> read_light(ByteSource& file, const std::string& layer) {
    const PictureKind kind = picture_kind_of(file);
    if (kind == PictureKind::exr) {
        ExrReader reader(file, 0);
        TESSERA_TRY(reader.open(layer));
        TESSERA_TRY(check_size(reader.shape().width, reader.shape().height));
        LightImage image;
        TESSERA_TRY(reader.read_light(image));
        return image;
    }
    if (!layer.empty())
        return Status(ErrorCode::bad_argument,
                      "only EXR pictures have layers, such as '" + layer.substr(0, 60) + "'");
    if (kind != PictureKind::hdr && kind != PictureKind::pfm)
        return not_a_picture(file, "an .hdr, .exr or .pfm picture");
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole(file));
    if (kind == PictureKind::hdr)
        return read_hdr(bytes);
    TESSERA_TRY_ASSIGN(const HeldPicture picture, read_pfm(bytes));
    return light_of(picture);
}

} // namespace

PictureKind picture_kind_of(ByteSource& file) {
    char begin[12];
    const std::size_t length = std::min<std::uint64_t>(sizeof begin, file.size());
    const Status read = file.read(0, std::as_writable_bytes(std::span(begin, length)));
    if (!read.ok())
        return PictureKind::none;
    const PictureKind kind = kind_of({begin, length});
    return kind == PictureKind::none && is_tga(file, {begin, length}) ? PictureKind::tga : kind;
}

Result<std::unique_ptr<PictureReader>> open_picture_file(ByteSource& file,
                                                         const PictureOptions& options) {
    auto reader = open_by_kind(file, options);
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
    case PictureKind::pfm: {
        TESSERA_TRY_ASSIGN(const HeldPicture picture, read_pfm(bytes));
        return to_srgb(light_of(picture));
    }
    case PictureKind::pnm: {
        TESSERA_TRY_ASSIGN(HeldPicture picture, read_pnm(bytes));
        return read_rgba(held(std::move(picture)));
    }
    case PictureKind::tiff:
        return read_rgba(open_tiff(*source, Exif::followed));
    case PictureKind::exr:
        return not_supported("an EXR as a texture");
    case PictureKind::tga: // not by its first bytes
    case PictureKind::none:
        break;
    }
    if (const char* kind = unsupported_kind(begin))
        return not_supported(kind);
    if (const std::string kind = known_kind(bytes); !kind.empty())
        return Status(ErrorCode::invalid_file, "not a picture, but " + kind);
    return read_tga(bytes);
}

Result<LightImage> read_light_image(ByteSource& file, const std::string& layer) {
    auto image = read_light(file, layer);
    return image.ok() ? std::move(image) : named(image.status(), file.name());
}

Status PictureReader::read_rows(SampleType type, std::uint32_t first, std::uint32_t last,
                                const PictureRow& row) {
    const Status status = read(type, first, last, row);
    return name_.empty() ? status : named(status, name_);
}

} // namespace tessera::corpus
