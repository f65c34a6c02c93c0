#include "tools/texture_io/texture_io.h"

#include "codec/decoder.h"
#include "corpus/picture_file.h"
#include "format/output_file.h"
#include "tools/http/open_bytes.h"
#include "tools/support/camera_grid.h"
#include "tools/support/fill_text.h"
#include "tools/support/json_text.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/standard_streams.h"
#include "tools/texture_io/exr_writer.h"
#include "tools/texture_io/film_io.h"
#include "tools/texture_io/picture_format.h"
#include "tools/texture_io/picture_io.h"
#include "tools/texture_io/raw_io.h"
#include "tools/texture_io/views_io.h"

#include <algorithm>
#include <array>
#include <filesystem>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// The ending of a raw file's name, and the samples that it implies.
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
    const std::string ending = to_path(path).extension().string();
    for (const RawEnding& known : raw_endings)
        if (ending == known.ending)
            return &known;
    return nullptr;
}

std::string without_trailing_slashes(std::string path) {
    while (to_path(path).has_relative_path() && !to_path(path).has_filename())
        path.pop_back();
    return path;
}

Status unknown_kind(const std::string& path) {
    if (is_url(path))
        return {ErrorCode::bad_argument,
                path + ": only .tess files, and .glb files that hold one, are read over a network, "
                       "and none is written"};
    return {ErrorCode::bad_argument,
            path + ": the name has no known ending; known are .tess, .exr, .rgb .rgba .gray "
                   ".ya (and with 16f appended), .raw, .png, .jpg and other pictures, .y4m, and "
                   "folder/ for views"};
}

// The kind of an input that has neither a signature nor a known name.
Status unknown_input(const std::string& path, const std::string& name) {
    if (path != standard_stream)
        return unknown_kind(path);
    return {
        ErrorCode::bad_argument,
        name + ": not a .tess file, a film or a known picture; raw samples need --size, --type and "
               "--channels"};
}

// From the signature; raw samples have none. Signatures of two letters are no evidence against a
// name.
TextureKind kind_of_content(ByteSource& file) {
    constexpr unsigned char tess[] = {0x89, 'T', 'E', 'S', 'S', 'E', 'R', 'A', '\r', '\n', 0x1a};
    std::array<unsigned char, 11> begin{};
    const std::size_t length = std::min<std::uint64_t>(begin.size(), file.size());
    if (!file.read(0, std::as_writable_bytes(std::span(begin)).first(length)).ok())
        return TextureKind::unknown;
    if (length >= sizeof tess && std::ranges::equal(tess, std::span(begin).first(sizeof tess)))
        return TextureKind::tess;
    if (is_film(file))
        return TextureKind::picture;
    switch (corpus::picture_kind_of(file)) {
    case corpus::PictureKind::exr:
        return TextureKind::exr;
    case corpus::PictureKind::none:
    case corpus::PictureKind::bmp:
    case corpus::PictureKind::tga:
    case corpus::PictureKind::pnm:
    case corpus::PictureKind::pfm:
        return TextureKind::unknown;
    default:
        return TextureKind::picture;
    }
}

const char* words_for(TextureKind kind) {
    switch (kind) {
    case TextureKind::tess:
        return "a .tess file";
    case TextureKind::exr:
        return "an EXR picture";
    case TextureKind::picture:
        return "a picture";
    case TextureKind::views:
        return "a folder";
    case TextureKind::raw:
        return "a raw file";
    case TextureKind::unknown:
        break;
    }
    return "no .tess file";
}

// A compressed file with its bytes and decoder.
class TessSource : public TexelSource {
public:
    static Result<std::unique_ptr<TessSource>> open(std::unique_ptr<ByteSource> bytes,
                                                    const DecodeOptions& options) {
        TESSERA_TRY_ASSIGN(auto decoder, Decoder::open(*bytes, options));
        return std::unique_ptr<TessSource>(new TessSource(std::move(bytes), std::move(decoder)));
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

Status open_tess(std::unique_ptr<ByteSource> bytes, const TextureHints& hints,
                 OpenedTexture& opened) {
    const std::string path = bytes->name();
    TESSERA_TRY_ASSIGN(auto source, TessSource::open(std::move(bytes), hints.decode));
    const TextureDesc& desc = source->desc();
    if (hints.size && *hints.size != desc.size)
        return {ErrorCode::bad_argument,
                path + ": is " + to_string(desc.size) + ", not " + to_string(*hints.size)};
    opened.metadata = source->decoder().container().metadata();
    opened.description = source->decoder().container().description();
    opened.decoder = &source->decoder();
    opened.source = std::move(source);
    return {};
}

// JSON replaces bytes that are not.
bool is_utf8(const std::string& text) {
    return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)) == text;
}

void take_facts(const ViewsFacts& facts, OpenedTexture& opened) {
    opened.description = facts.description;
    if (facts.told.empty())
        return;
    const Extent4& size = opened.source->desc().size;
    opened.told = facts.told;
    opened.planar = !facts.described && std::uint64_t{size[axis_s]} * size[axis_t] > 1;
    const std::string layout = to_string(facts.layout);
    // Metadata is UTF-8, but file names may hold any bytes.
    if (!layout.empty() && is_utf8(layout) && printable(layout) == layout)
        opened.metadata[views_key] = layout;
    if (!facts.layout.cameras.empty())
        opened.metadata[cameras_key] = facts.layout.cameras;
}

// What a raw file holds, from its name and the hints.
Result<TextureDesc> raw_desc(const std::string& path, const TextureHints& hints) {
    const RawEnding* known = raw_ending(path);
    const RawEnding ending = known != nullptr ? *known : RawEnding{};
    if (!hints.size)
        return Status(ErrorCode::bad_argument,
                      path + ": a raw file does not store its size; say --size UxVxSxT");
    TextureDesc desc;
    desc.size = *hints.size;
    const auto type = hints.type ? hints.type : ending.type;
    const auto channels = hints.channels ? hints.channels : ending.channels;
    if (!type || !channels)
        return Status(ErrorCode::bad_argument,
                      path + ": the name does not imply the samples; say --type and --channels");
    desc.type = *type;
    desc.channels = *channels;
    return desc;
}

Status check_raw_ending(const std::string& path, const TextureDesc& desc) {
    const RawEnding& ending = *raw_ending(path);
    if (ending.channels.value_or(desc.channels) == desc.channels &&
        ending.type.value_or(desc.type) == desc.type)
        return {};
    return {ErrorCode::bad_argument, path + ": the ending contradicts a texture of " +
                                         std::to_string(desc.channels) + " channels of " +
                                         name_of(desc.type) + " (.raw fits any)"};
}

} // namespace

TextureKind kind_of(const std::string& path) {
    std::error_code ignored;
    if (path.empty())
        return TextureKind::unknown;
    if (is_url(path))
        return without_query(path).ends_with(".tess") || is_glb_name(path) ? TextureKind::tess
                                                                           : TextureKind::unknown;
    if (!to_path(path).has_filename() || fs::is_directory(to_path(path), ignored))
        return TextureKind::views;
    const std::string ending = to_path(split_glb_name(path).file).extension().string();
    if (ending == ".tess" || ending == ".glb")
        return TextureKind::tess;
    if (ending == ".exr")
        return TextureKind::exr;
    if (picture_kind_of_name(path) != corpus::PictureKind::none || ending == ".y4m")
        return ending == ".EXR" ? TextureKind::exr : TextureKind::picture;
    return raw_ending(path) ? TextureKind::raw : TextureKind::unknown;
}

TextureKind kind_of_input(const std::string& path) {
    if (const TextureKind named = kind_of(path); named == TextureKind::views || is_url(path))
        return named;
    const auto bytes = open_bytes(path);
    const TextureKind held = bytes.ok() ? kind_of_content(**bytes) : TextureKind::unknown;
    return held != TextureKind::unknown ? held : kind_of(path);
}

Result<std::unique_ptr<ByteSource>> open_tess_bytes(const std::string& path, const char* verb) {
    const TextureKind named = kind_of(path);
    if (is_url(path) && named != TextureKind::tess)
        return unknown_kind(path);
    auto bytes = open_bytes(path);
    const TextureKind held = bytes.ok() && !is_url(path) ? kind_of_content(**bytes) : named;
    const TextureKind kind = held != TextureKind::unknown ? held : named;
    if (kind == TextureKind::tess || (kind == TextureKind::unknown && !bytes.ok()))
        return bytes;
    return Status(ErrorCode::bad_argument,
                  path + ": is " + words_for(kind) + "; " + verb + " reads .tess files");
}

Result<OpenedTexture> open_texture(const std::string& path, const TextureHints& hints) {
    OpenedTexture opened;
    opened.kind = kind_of(path);
    ViewsFacts facts;
    if (opened.kind == TextureKind::views) {
        TESSERA_TRY_ASSIGN(opened.source, open_views(without_trailing_slashes(path), hints, facts));
        take_facts(facts, opened);
        return opened;
    }
    if (is_url(path) && opened.kind != TextureKind::tess)
        return unknown_kind(path);
    auto bytes = open_bytes(path);
    if (bytes.ok() && !is_url(path))
        if (const TextureKind held = kind_of_content(**bytes); held != TextureKind::unknown)
            opened.kind = held;
    const std::string name = bytes.ok() ? (*bytes)->name() : path;
    if (opened.kind == TextureKind::unknown && hints.size && hints.type && hints.channels)
        opened.kind = TextureKind::raw;
    if (opened.kind == TextureKind::unknown && bytes.ok() && !is_url(path) &&
        corpus::picture_kind_of(**bytes) != corpus::PictureKind::none)
        opened.kind = TextureKind::picture;
    TextureDesc raw;
    if (opened.kind == TextureKind::raw) { // missing hints are reported before a missing file
        TESSERA_TRY_ASSIGN(raw, raw_desc(path == standard_stream ? name : path, hints));
    }
    if (!bytes.ok() && (opened.kind != TextureKind::unknown || path == standard_stream))
        return bytes.status();
    switch (opened.kind) {
    case TextureKind::tess:
        TESSERA_TRY(open_tess(std::move(*bytes), hints, opened));
        return opened;
    case TextureKind::exr:
    case TextureKind::picture: {
        const bool film = is_film(**bytes);
        TESSERA_TRY_ASSIGN(opened.source, film ? open_film(std::move(*bytes), hints, facts)
                                               : open_picture(std::move(*bytes), hints, facts));
        take_facts(facts, opened);
        return opened;
    }
    case TextureKind::raw: {
        TESSERA_TRY_ASSIGN(opened.source, open_raw(std::move(*bytes), raw));
        return opened;
    }
    case TextureKind::views:
    case TextureKind::unknown:
        break;
    }
    return unknown_input(path, name);
}

Result<std::pair<OpenedTexture, OpenedTexture>>
open_two_textures(const std::string& first, const std::string& second, TextureHints hints) {
    const bool raw_first = kind_of_input(first) == TextureKind::raw;
    TESSERA_TRY_ASSIGN(auto one, open_texture(raw_first ? second : first, hints));
    const std::string& left = raw_first ? first : second;
    if (!hints.size && kind_of_input(left) == TextureKind::raw)
        hints.size = one.source->desc().size;
    TESSERA_TRY_ASSIGN(auto other, open_texture(left, hints));
    if (raw_first)
        std::swap(one, other);
    return std::pair(std::move(one), std::move(other));
}

Status check_texture_output(const std::string& path, const TextureDesc& desc,
                            const ViewLayout& layout) {
    if (path == standard_stream)
        return check_standard_output();
    switch (kind_of(path)) {
    case TextureKind::exr:
        return check_output_path(path);
    case TextureKind::views:
        TESSERA_TRY(check_parent_folders(without_trailing_slashes(path)));
        return check_views_output(desc, layout).with_context(path);
    case TextureKind::raw:
        TESSERA_TRY(check_output_path(path));
        TESSERA_TRY(check_parent_folders(path, desc.box_bytes(Box4::whole(desc.size))));
        return check_raw_ending(path, desc);
    case TextureKind::tess:
        return {ErrorCode::bad_argument,
                path + ": use tessera " +
                    (is_glb_name(path) ? "convert to make a .glb" : "encode to compress")};
    case TextureKind::picture:
        TESSERA_TRY(check_output_path(path));
        return check_picture_output(path, desc, layout);
    case TextureKind::unknown:
        break;
    }
    return unknown_kind(path);
}

Result<std::unique_ptr<TexelSink>> create_texture(const std::string& path, const TextureDesc& desc,
                                                  const Description& description, unsigned threads,
                                                  const ViewLayout& layout) {
    TESSERA_TRY(check_texture_output(path, desc, layout));
    if (path == standard_stream)
        return raw_to_standard_output(desc);
    TESSERA_TRY(make_parent_folders(path));
    switch (kind_of(path)) {
    case TextureKind::exr:
        return create_exr(path, desc, description, threads);
    case TextureKind::views:
        return create_views(without_trailing_slashes(path), desc, description, layout, threads);
    case TextureKind::picture:
        return create_picture(path, desc, layout);
    default:
        return create_raw(path, desc);
    }
}

Status with_partial_hint(const Status& status, const std::string& name,
                         const DecodeOptions& options) {
    if (status.code() != ErrorCode::invalid_file || kind_of_input(name) != TextureKind::tess)
        return status;
    const auto file = open_bytes(name);
    return file.ok() ? with_partial_hint(status, **file, options) : status;
}

Status with_partial_hint(const Status& status, const std::string& first, const std::string& second,
                         const DecodeOptions& options) {
    const Status hinted = with_partial_hint(status, first, options);
    return hinted.message() != status.message() ? hinted
                                                : with_partial_hint(status, second, options);
}

} // namespace tessera
