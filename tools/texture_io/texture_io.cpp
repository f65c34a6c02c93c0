#include "tools/texture_io/texture_io.h"

#include "codec/decoder.h"
#include "tools/texture_io/exr_io.h"
#include "tools/http/open_bytes.h"
#include "tools/support/parse.h"
#include "tools/texture_io/png_views_io.h"
#include "tools/texture_io/raw_io.h"

#include <filesystem>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// What the ending of a raw file's name says.
struct RawEnding {
    const char* ending;
    std::optional<std::uint8_t> channels;
    std::optional<SampleType> type;
};

const RawEnding raw_endings[] = {
    {".rgb", 3, SampleType::unorm8},     {".rgba", 4, SampleType::unorm8},
    {".gray", 1, SampleType::unorm8},    {".grey", 1, SampleType::unorm8},
    {".ya", 2, SampleType::unorm8},      {".rgb16f", 3, SampleType::half16},
    {".rgba16f", 4, SampleType::half16}, {".gray16f", 1, SampleType::half16},
    {".grey16f", 1, SampleType::half16}, {".ya16f", 2, SampleType::half16},
    {".raw", std::nullopt, std::nullopt}};

const RawEnding* raw_ending(const std::string& path) {
    const std::string ending = fs::path(path).extension().string();
    for (const RawEnding& known : raw_endings)
        if (ending == known.ending)
            return &known;
    return nullptr;
}

std::string without_trailing_slashes(std::string path) {
    while (path.size() > 1 && path.back() == '/')
        path.pop_back();
    return path;
}

Status unknown_kind(const std::string& path) {
    if (is_url(path))
        return {ErrorCode::bad_argument,
                path + ": over a network only .tess files are read, and none is written"};
    return {ErrorCode::bad_argument,
            path + ": this name says no kind of texture; known are .tess, .exr, .rgb .rgba .gray "
                   ".ya (and with 16f appended), .raw, and folder/ for PNG views"};
}

// A compressed file that owns what it is read through.
class TessSource : public TexelSource {
public:
    static Result<std::unique_ptr<TessSource>> open(const std::string& path,
                                                    const DecodeOptions& options) {
        auto bytes = open_bytes(path);
        if (!bytes.ok())
            return bytes.status();
        auto decoder = Decoder::open(**bytes, options);
        if (!decoder.ok())
            return decoder.status();
        return std::unique_ptr<TessSource>(new TessSource(std::move(*bytes), std::move(*decoder)));
    }
    const Decoder& decoder() const { return decoder_; }
    const TextureDesc& desc() const override { return texels_->desc(); }
    Locality locality() const override { return texels_->locality(); }
    bool cheap_to_reread() const override { return texels_->cheap_to_reread(); }
    Status begin_slab(const Box4& box) override { return texels_->begin_slab(box); }
    Status read(const Box4& box, std::span<std::byte> out) override {
        return texels_->read(box, out);
    }

private:
    TessSource(std::unique_ptr<ByteSource> bytes, Decoder decoder)
        : bytes_(std::move(bytes)), decoder_(std::move(decoder)),
          texels_(decoded_source(decoder_)) {}
    std::unique_ptr<ByteSource> bytes_;
    Decoder decoder_;
    std::unique_ptr<TexelSource> texels_;
};

Status open_tess(const std::string& path, const TextureHints& hints, OpenedTexture& opened) {
    auto source = TessSource::open(path, hints.decode);
    if (!source.ok())
        return source.status();
    const TextureDesc& desc = (*source)->desc();
    if (hints.size && *hints.size != desc.size)
        return {ErrorCode::bad_argument,
                path + ": is " + to_string(desc.size) + ", not " + to_string(*hints.size)};
    opened.metadata = (*source)->decoder().container().metadata();
    opened.description = (*source)->decoder().container().description();
    opened.decoder = &(*source)->decoder();
    opened.source = std::move(*source);
    return {};
}

Result<TextureDesc> raw_desc(const std::string& path, const TextureHints& hints) {
    const RawEnding& ending = *raw_ending(path);
    if (!hints.size)
        return Status(ErrorCode::bad_argument,
                      path + ": a raw file does not know its size; say --size UxVxSxT");
    TextureDesc desc;
    desc.size = *hints.size;
    const auto type = hints.type ? hints.type : ending.type;
    const auto channels = hints.channels ? hints.channels : ending.channels;
    if (!type || !channels)
        return Status(ErrorCode::bad_argument,
                      path + ": .raw says nothing of its samples; say --type and --channels");
    desc.type = *type;
    desc.channels = *channels;
    return desc;
}

Status check_raw_ending(const std::string& path, const TextureDesc& desc) {
    const RawEnding& ending = *raw_ending(path);
    if (ending.channels.value_or(desc.channels) == desc.channels &&
        ending.type.value_or(desc.type) == desc.type)
        return {};
    return {ErrorCode::bad_argument, path + ": the name does not fit a texture of " +
                                         std::to_string(desc.channels) + " channels of " +
                                         name_of(desc.type) + " (.raw fits all)"};
}

} // namespace

TextureKind kind_of(const std::string& path) {
    std::error_code ignored;
    if (path.empty())
        return TextureKind::unknown;
    if (is_url(path))
        return without_query(path).ends_with(".tess") ? TextureKind::tess : TextureKind::unknown;
    if (path.back() == '/' || fs::is_directory(path, ignored))
        return TextureKind::png_views;
    const std::string ending = fs::path(path).extension().string();
    if (ending == ".tess")
        return TextureKind::tess;
    if (ending == ".exr")
        return TextureKind::exr;
    return raw_ending(path) ? TextureKind::raw : TextureKind::unknown;
}

Result<OpenedTexture> open_texture(const std::string& path, const TextureHints& hints) {
    OpenedTexture opened;
    opened.kind = kind_of(path);
    Result<std::unique_ptr<TexelSource>> source = Status();
    switch (opened.kind) {
    case TextureKind::tess:
        TESSERA_TRY(open_tess(path, hints, opened));
        return opened;
    case TextureKind::exr:
        source = open_exr(path, hints, opened.description);
        break;
    case TextureKind::png_views:
        source = open_png_views(without_trailing_slashes(path), hints, opened.description);
        break;
    case TextureKind::raw: {
        const auto desc = raw_desc(path, hints);
        if (!desc.ok())
            return desc.status();
        source = open_raw(path, *desc);
        break;
    }
    case TextureKind::unknown:
        return unknown_kind(path);
    }
    if (!source.ok())
        return source.status();
    opened.source = std::move(*source);
    return opened;
}

Result<std::pair<OpenedTexture, OpenedTexture>>
open_two_textures(const std::string& first, const std::string& second, TextureHints hints) {
    const bool raw_first = kind_of(first) == TextureKind::raw;
    auto one = open_texture(raw_first ? second : first, hints);
    if (!one.ok())
        return one.status();
    const std::string& left = raw_first ? first : second;
    if (!hints.size && kind_of(left) == TextureKind::raw)
        hints.size = one->source->desc().size;
    auto other = open_texture(left, hints);
    if (!other.ok())
        return other.status();
    if (raw_first)
        std::swap(*one, *other);
    return std::pair(std::move(*one), std::move(*other));
}

Status check_output_path(const std::string& path) {
    if (is_url(path))
        return {ErrorCode::bad_argument, path + ": cannot write to a URL"};
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    const fs::path folder = fs::path(path).parent_path();
    if (!folder.empty() && !fs::is_directory(folder, ignored))
        return {ErrorCode::io, path + ": there is no folder " + folder.string()};
    if (!fs::exists(status) || fs::is_regular_file(status))
        return {};
    return {ErrorCode::io, path + ": exists and is not a plain file"};
}

Result<std::unique_ptr<TexelSink>> create_texture(const std::string& path, const TextureDesc& desc,
                                                  const Description& description,
                                                  unsigned threads) {
    switch (kind_of(path)) {
    case TextureKind::exr:
        TESSERA_TRY(check_output_path(path));
        return create_exr(path, desc, description, threads);
    case TextureKind::png_views:
        return create_png_views(without_trailing_slashes(path), desc, description, threads);
    case TextureKind::raw:
        TESSERA_TRY(check_output_path(path));
        TESSERA_TRY(check_raw_ending(path, desc));
        return create_raw(path, desc);
    case TextureKind::tess:
        return Status(ErrorCode::bad_argument, path + ": use tessera encode to compress");
    case TextureKind::unknown:
        break;
    }
    return unknown_kind(path);
}

} // namespace tessera
