#include "tools/http/glb_payload.h"

#include "format/output_file.h"
#include "tools/support/json_text.h"
#include "tools/support/output_folders.h"
#include "tools/support/url.h"

#include <algorithm>
#include <array>
#include <filesystem>

namespace tessera {
namespace {

constexpr std::uint32_t glb_magic = 0x46546C67, json_chunk = 0x4E4F534A, bin_chunk = 0x004E4942;
constexpr std::uint64_t most_json_bytes = 16u << 20;
constexpr int deepest_json = 64; // what is nested more deeply takes much memory, and is left out

// A part of another source.
class PartOfFile final : public ByteSource {
public:
    PartOfFile(std::unique_ptr<ByteSource> whole, const GlbPayload& part)
        : whole_(std::move(whole)), offset_(part.offset), size_(part.length) {}
    std::uint64_t size() const override { return size_; }
    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        TESSERA_TRY(check_range(*this, offset, out.size()));
        return whole_->read(offset_ + offset, out);
    }
    Status read_many(std::span<const ReadRequest> requests) override {
        std::vector<ReadRequest> moved(requests.begin(), requests.end());
        for (ReadRequest& request : moved) {
            TESSERA_TRY(check_range(*this, request.offset, request.out.size()));
            request.offset += offset_;
        }
        return whole_->read_many(moved);
    }
    bool wants_prefetch() const override { return whole_->wants_prefetch(); }
    std::string name() const override { return whole_->name(); }
    const ByteSource& whole() const { return *whole_; }

private:
    std::unique_ptr<ByteSource> whole_;
    std::uint64_t offset_, size_;
};

Status invalid_glb(const std::string& text) {
    return {ErrorCode::invalid_file, text};
}

template <std::size_t n>
Result<std::array<std::uint32_t, n>> read_words(ByteSource& file, std::uint64_t offset) {
    std::array<unsigned char, 4 * n> bytes{};
    TESSERA_TRY(file.read(offset, std::as_writable_bytes(std::span(bytes))));
    std::array<std::uint32_t, n> words{};
    for (std::size_t i = 0; i < bytes.size(); ++i)
        words[i / 4] |= std::uint32_t{bytes[i]} << 8 * (i % 4);
    return words;
}

// The JSON, and where the binary chunk lies.
struct OpenGlb {
    Json json;
    std::uint64_t bin_offset = 0, bin_bytes = 0; // no chunk: 0 bytes
};

Result<OpenGlb> read_glb(ByteSource& file) {
    if (file.size() < 20)
        return invalid_glb("the file ends within the header");
    TESSERA_TRY_ASSIGN(const auto head, read_words<5>(file, 0));
    const auto [magic, version, length, json_bytes, json_type] = head;
    if (version != 2)
        return Status(ErrorCode::unsupported, "is glTF version " + std::to_string(version) +
                                                  "; only version 2 can be read");
    if (json_type != json_chunk)
        return invalid_glb("the first chunk is not the JSON");
    const std::uint64_t json_end = 20 + std::uint64_t{json_bytes};
    if (json_bytes > most_json_bytes)
        return Status(ErrorCode::unsupported, "its JSON has " + std::to_string(json_bytes) +
                                                  " bytes; at most " +
                                                  std::to_string(most_json_bytes) + " can be read");
    if (json_end > file.size() || json_end > length)
        return invalid_glb("the file ends within the JSON");
    std::string text(json_bytes, '\0');
    TESSERA_TRY(file.read(20, std::as_writable_bytes(std::span(text))));
    OpenGlb glb;
    const auto is_wanted = [](int depth, Json::parse_event_t, const Json&) {
        return depth <= deepest_json;
    };
    glb.json = Json::parse(text, is_wanted, false);
    if (!glb.json.is_object())
        return invalid_glb("the JSON chunk is not a JSON object");
    if (json_end + 8 > length)
        return glb;
    if (json_end + 8 > file.size())
        return invalid_glb("the file ends before the binary chunk");
    TESSERA_TRY_ASSIGN(const auto chunk, read_words<2>(file, json_end));
    if (chunk[1] != bin_chunk)
        return glb;
    if (json_end + 8 + chunk[0] > length)
        return invalid_glb("the binary chunk ends beyond the length in the header");
    glb.bin_offset = json_end + 8;
    glb.bin_bytes = chunk[0];
    return glb;
}

// The member `key` of an object, or null.
const Json& member(const Json& object, const char* key) {
    static const Json nothing;
    const auto found = object.is_object() ? object.find(key) : object.end();
    return object.is_object() && found != object.end() ? *found : nothing;
}

// A list at the top of the JSON; an absent one is empty.
Result<const Json*> list_of(const Json& gltf, const char* name) {
    static const Json empty = Json::array();
    const Json& list = member(gltf, name);
    if (!list.is_null() && !list.is_array())
        return invalid_glb(std::string(name) + " is not a list");
    return list.is_null() ? &empty : &list;
}

// A whole number of an object. `where` names the object in messages.
Result<std::uint64_t> number_of(const Json& object, const char* key, const std::string& where,
                                std::optional<std::uint64_t> otherwise = {}) {
    const Json& value = member(object, key);
    if (value.is_number_unsigned())
        return value.get<std::uint64_t>();
    if (value.is_null() && otherwise)
        return *otherwise;
    return invalid_glb(where + " has no valid " + key);
}

// The entry of a list at the top of the JSON that `object` names by `key`.
Result<const Json*> named_by(const Json& gltf, const char* list_name, const Json& object,
                             const char* key, const std::string& where) {
    TESSERA_TRY_ASSIGN(const std::uint64_t index, number_of(object, key, where));
    TESSERA_TRY_ASSIGN(const Json* list, list_of(gltf, list_name));
    if (index >= list->size())
        return invalid_glb(where + " names entry " + std::to_string(index) + " of " + list_name +
                           ", which has " + std::to_string(list->size()));
    return &(*list)[static_cast<std::size_t>(index)];
}

// Whether all materials name textures that are there.
Status check_materials(const Json& gltf) {
    TESSERA_TRY_ASSIGN(const Json* materials, list_of(gltf, "materials"));
    for (std::size_t i = 0; i < materials->size(); ++i) {
        const Json& texture =
            member(member((*materials)[i], "pbrMetallicRoughness"), "baseColorTexture");
        if (!texture.is_null())
            TESSERA_TRY(named_by(gltf, "textures", texture, "index",
                                 "the base colour of materials[" + std::to_string(i) + "]")
                            .status());
    }
    return {};
}

// The objects of the extension, each with its place.
Result<std::vector<std::pair<const Json*, std::string>>> find_extensions(const Json& gltf) {
    TESSERA_TRY_ASSIGN(const Json* textures, list_of(gltf, "textures"));
    std::vector<std::pair<const Json*, std::string>> found;
    for (std::size_t i = 0; i < textures->size(); ++i) {
        const Json& extension = member(member((*textures)[i], "extensions"), glb_extension);
        if (!extension.is_null())
            found.emplace_back(&extension, "textures[" + std::to_string(i) + "]: " + glb_extension);
    }
    if (found.empty())
        return Status(ErrorCode::bad_argument, "is a binary glTF model without a Tessera texture; "
                                               "tessera bake makes one of it");
    return found;
}

Result<GlbPayload> payload_of(const OpenGlb& glb, const Json* extension, const std::string& where) {
    const Json& mime = member(*extension, "mimeType");
    if (mime.is_string() && mime.get<std::string>() != tess_mime_type)
        return Status(ErrorCode::unsupported,
                      where + " has a mimeType that is not " + std::string(tess_mime_type));
    TESSERA_TRY_ASSIGN(const Json* view,
                       named_by(glb.json, "bufferViews", *extension, "bufferView", where));
    const std::string view_name = where + ": its buffer view";
    TESSERA_TRY_ASSIGN(const Json* buffer,
                       named_by(glb.json, "buffers", *view, "buffer", view_name));
    if (buffer != &glb.json["buffers"][0] || buffer->contains("uri"))
        return Status(ErrorCode::unsupported,
                      view_name + " is not in the binary chunk of the file");
    TESSERA_TRY_ASSIGN(const std::uint64_t buffer_bytes,
                       number_of(*buffer, "byteLength", "buffers[0]"));
    TESSERA_TRY_ASSIGN(const std::uint64_t begin, number_of(*view, "byteOffset", view_name, 0));
    TESSERA_TRY_ASSIGN(const std::uint64_t length, number_of(*view, "byteLength", view_name));
    const std::uint64_t held = std::min(buffer_bytes, glb.bin_bytes);
    if (begin > held || length > held - begin)
        return invalid_glb(view_name + " covers the bytes " + std::to_string(begin) + " to " +
                           std::to_string(begin) + " + " + std::to_string(length) +
                           ", but its buffer has " + std::to_string(held));
    return GlbPayload{glb.bin_offset + begin, length};
}

Result<std::vector<GlbPayload>> payloads_in(const OpenGlb& glb) {
    TESSERA_TRY_ASSIGN(const auto found, find_extensions(glb.json));
    TESSERA_TRY(check_materials(glb.json));
    std::vector<GlbPayload> payloads;
    for (const auto& [extension, where] : found) {
        TESSERA_TRY_ASSIGN(payloads.emplace_back(), payload_of(glb, extension, where));
    }
    return payloads;
}

bool is_texture_number(const std::string& text) {
    constexpr std::size_t most_digits = 9;
    return !text.empty() && text.size() <= most_digits &&
           text.find_first_not_of("0123456789") == std::string::npos;
}

Result<GlbPayload> chosen(const std::vector<GlbPayload>& payloads,
                          std::optional<std::size_t> texture, const std::string& name) {
    const std::size_t count = payloads.size();
    if (!texture && count > 1)
        return Status(ErrorCode::bad_argument, name + ": has " + std::to_string(count) +
                                                   " Tessera textures; name one of them, " + name +
                                                   "#0 to #" + std::to_string(count - 1));
    if (texture.value_or(0) >= count)
        return Status(ErrorCode::bad_argument, name + "#" + std::to_string(*texture) +
                                                   ": there is no such texture; the first of " +
                                                   std::to_string(count) + " is #0");
    return payloads[texture.value_or(0)];
}

} // namespace

GlbName split_glb_name(const std::string& name) {
    const std::size_t hash = name.rfind('#');
    std::error_code ignored;
    if (hash == std::string::npos || !is_texture_number(name.substr(hash + 1)) ||
        !without_query(name.substr(0, hash)).ends_with(".glb") ||
        (!is_url(name) && std::filesystem::exists(to_path(name), ignored)))
        return {name, {}};
    return {name.substr(0, hash), std::stoul(name.substr(hash + 1))};
}

Result<std::vector<GlbPayload>> find_glb_payloads(ByteSource& file) {
    auto glb = read_glb(file);
    if (!glb.ok())
        return std::move(glb).status().with_context(file.name());
    return payloads_in(*glb).with_context(file.name());
}

bool is_glb(ByteSource& file) {
    if (file.size() < 4)
        return false;
    const auto magic = read_words<1>(file, 0);
    return magic.ok() && (*magic)[0] == glb_magic; // a failure repeats for whoever reads `file`
}

Result<std::unique_ptr<ByteSource>> unpack_glb(std::unique_ptr<ByteSource> file,
                                               std::optional<std::size_t> texture) {
    if (!is_glb(*file)) {
        if (texture)
            return Status(ErrorCode::bad_argument, file->name() + ": is no .glb, so that #" +
                                                       std::to_string(*texture) +
                                                       " names nothing in it");
        return file;
    }
    TESSERA_TRY_ASSIGN(const auto payloads, find_glb_payloads(*file));
    TESSERA_TRY_ASSIGN(GlbPayload payload, chosen(payloads, texture, file->name()));
    if (payload.offset >= file->size())
        return invalid_glb("the file ends before the Tessera texture").with_context(file->name());
    // Of a file that is cut short, what is there.
    payload.length = std::min(payload.length, file->size() - payload.offset);
    return std::unique_ptr<ByteSource>(std::make_unique<PartOfFile>(std::move(file), payload));
}

const ByteSource& whole_file(const ByteSource& source) {
    const auto* const part = dynamic_cast<const PartOfFile*>(&source);
    return part != nullptr ? part->whole() : source;
}

} // namespace tessera
