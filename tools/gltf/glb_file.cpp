#include "tools/gltf/glb_file.h"

#include "format/metadata.h"
#include "format/output_file.h"
#include "tools/http/glb_payload.h"
#include "tools/support/copy_bytes.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::uint64_t most_glb_bytes = 0xFFFFFFFF;
constexpr const char* meshopt_extension = "EXT_meshopt_compression";

void append_word(std::vector<std::byte>& out, std::uint64_t word) {
    for (int shift = 0; shift < 32; shift += 8)
        out.push_back(static_cast<std::byte>(word >> shift));
}

std::uint64_t padded(std::uint64_t bytes) {
    return (bytes + 3) / 4 * 4;
}

std::size_t added(Json& list, Json entry) {
    list.push_back(std::move(entry));
    return list.size() - 1;
}

} // namespace

GlbFile::GlbFile() {
    json = {
        {"asset", {{"version", "2.0"}, {"generator", std::string("Tessera ") + library_version}}},
        {"extensionsUsed", Json::array()}};
    use_extension("KHR_materials_unlit", false);
    use_extension(glb_extension, false);
}

std::size_t GlbFile::append(std::span<const std::byte> bytes) {
    const std::size_t offset = chunk_.size();
    chunk_.insert(chunk_.end(), bytes.begin(), bytes.end());
    chunk_.resize(padded(chunk_.size())); // accessors begin at multiples of 4
    return offset;
}

std::size_t GlbFile::add_view(std::span<const std::byte> bytes, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", append(bytes)}, {"byteLength", bytes.size()}};
    if (target != no_target)
        view["target"] = target;
    return added(views_, std::move(view));
}

// Buffer 1 stands for the bytes that readers get from the streams in buffer 0. It has no data.
std::size_t GlbFile::add_meshopt_view(const MeshoptView& view, int target) {
    use_extension(meshopt_extension, true);
    Json out = {{"buffer", 1},
                {"byteOffset", unpacked_bytes_},
                {"byteLength", view.count * view.stride},
                {"target", target}};
    if (target == vertices)
        out["byteStride"] = view.stride;
    Json stream = {{"buffer", 0},
                   {"byteOffset", append(view.stream)},
                   {"byteLength", view.stream.size()},
                   {"byteStride", view.stride},
                   {"count", view.count},
                   {"mode", view.mode}};
    if (view.filter != nullptr)
        stream["filter"] = view.filter;
    out["extensions"][meshopt_extension] = std::move(stream);
    unpacked_bytes_ = padded(unpacked_bytes_ + view.count * view.stride);
    return added(views_, std::move(out));
}

std::size_t GlbFile::add_accessor(Json accessor) {
    return added(accessors_, std::move(accessor));
}

std::size_t GlbFile::add_material(Json material) {
    return added(json["materials"], std::move(material));
}

std::size_t GlbFile::add_texture(Json texture, ByteSource& tess) {
    files_.push_back(&tess);
    return added(json["textures"], std::move(texture));
}

void GlbFile::use_extension(const char* name, bool required) {
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
        if (required || list == std::string("extensionsUsed"))
            if (std::find(json[list].begin(), json[list].end(), name) == json[list].end())
                json[list].push_back(name);
}

Result<std::uint64_t> GlbFile::write(const std::string& output) {
    std::uint64_t chunk_bytes = chunk_.size();
    for (std::size_t i = 0; i < files_.size(); ++i) {
        json["textures"][i]["extensions"][glb_extension] = {{"bufferView", views_.size()},
                                                            {"mimeType", tess_mime_type}};
        views_.push_back(
            {{"buffer", 0}, {"byteOffset", chunk_bytes}, {"byteLength", files_[i]->size()}});
        chunk_bytes += padded(files_[i]->size());
    }
    json["bufferViews"] = views_;
    json["accessors"] = accessors_;
    json["buffers"][0]["byteLength"] = chunk_bytes;
    if (unpacked_bytes_ > 0) {
        json["buffers"][1]["byteLength"] = unpacked_bytes_;
        json["buffers"][1]["extensions"][meshopt_extension]["fallback"] = true;
    }
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize(padded(text.size()), ' ');
    const std::uint64_t all = 12 + 8 + text.size() + 8 + chunk_bytes;
    if (all > most_glb_bytes)
        return Status(ErrorCode::unsupported, output + ": would have " + human_bytes(all) +
                                                  ", but a .glb has at most 4 GiB");
    std::vector<std::byte> head;
    for (const std::uint64_t word : {std::uint64_t{0x46546C67}, std::uint64_t{2}, all,
                                     std::uint64_t{text.size()}, std::uint64_t{0x4E4F534A}})
        append_word(head, word);
    const auto letters = std::as_bytes(std::span(text));
    head.insert(head.end(), letters.begin(), letters.end());
    append_word(head, chunk_bytes);
    append_word(head, 0x004E4942);
    TESSERA_TRY(make_parent_folders(output));
    TESSERA_TRY_ASSIGN(OutputFile file, OutputFile::create(output));
    TESSERA_TRY(file.append(head));
    TESSERA_TRY(file.append(chunk_));
    for (ByteSource* const tess : files_) {
        TESSERA_TRY(copy_bytes(*tess, file));
        TESSERA_TRY(file.append(std::vector<std::byte>(padded(tess->size()) - tess->size())));
    }
    TESSERA_TRY(file.commit());
    return all;
}

} // namespace tessera
