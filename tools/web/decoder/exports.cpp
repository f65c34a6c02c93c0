// The functions that tessera.js calls. Each instance of the module holds one file with all of its
// layers, and web_select() says which layer the other functions concern. To close the file,
// JavaScript drops the instance and with it all of its memory. Functions that read bytes return an
// Answer, and web_error() returns the message of the last error.
#include "tools/web/decoder/atlas.h"
#include "tools/web/decoder/facts.h"
#include "tools/web/decoder/open_file.h"

#include <algorithm>

namespace tessera {

OpenFile file;

namespace {

// Bound on the result of a call. A 32-bit address space must also hold the decoder's working
// memory.
constexpr std::uint64_t most_result_bytes = std::uint64_t{1} << 30;

// Uninitialised memory for a result. Errors: over_budget.
Result<std::span<std::byte>> room_for(std::uint64_t bytes) {
    if (bytes > most_result_bytes)
        return Status(ErrorCode::over_budget, "the result has " + std::to_string(bytes) +
                                                  " bytes, more than the limit of " +
                                                  std::to_string(most_result_bytes) +
                                                  ": read the box in parts");
    if (bytes > file.result_bytes) {
        file.result.reset(); // freed first, because both together may not fit
        file.result_bytes = static_cast<std::size_t>(bytes);
        file.result = std::make_unique_for_overwrite<std::byte[]>(file.result_bytes);
    }
    return std::span(file.result.get(), static_cast<std::size_t>(bytes));
}

Status open() {
    TESSERA_TRY_ASSIGN(Decoder decoder, Decoder::open(*file.bytes, file.options));
    file.first.emplace(std::move(decoder));
    return {};
}

Status open_further() {
    const ContainerReader& first = file.first->container();
    TESSERA_TRY_ASSIGN(file.layers, open_layers(*file.bytes, first, file.options));
    return {};
}

// Reads the bytes of all tiles that the box touches.
Status fetch(std::uint32_t level, const std::uint32_t* corners) {
    TESSERA_TRY_ASSIGN(const Box4 box, checked_box(level, corners));
    if (!container().wants_prefetch())
        return {};
    std::vector<std::uint64_t> tiles =
        level == 0 ? container().tiles_touched(box)
                   : container().grid(level == of_grid ? 0 : level).tiles_touched(box);
    if (level != of_grid)
        for (std::uint64_t& tile : tiles)
            tile += container().levels()[level].first_tile;
    for (std::span<const std::uint64_t> left = tiles; !left.empty();) {
        TESSERA_TRY_ASSIGN(const std::size_t brought, container().prefetch(left));
        left = left.subspan(brought);
    }
    return {};
}

Status read_box(std::uint32_t level, const Box4& box, std::span<std::byte> out) {
    if (level == of_grid)
        return decoder().decode_grid_box(box, out, {1, Integrity::page, {}, {}});
    return level == 0 ? decoder().decode_box(box, out, {.threads = 1})
                      : decoder().decode_coarse_box(level, box, out);
}

// Coarse levels are small, so all of their texels are decoded before they are converted.
Status read_atlas(std::uint32_t level, const Box4& box, std::span<std::byte> rgba) {
    AtlasSink sink(decoder().desc(), box, rgba);
    if (level == 0)
        return decoder().decode(box, sink, 1);
    std::vector<std::byte> texels(static_cast<std::size_t>(decoder().desc().box_bytes(box)));
    TESSERA_TRY(read_box(level, box, texels));
    return sink.write(box, texels);
}

} // namespace

// Must be called first. size: bytes of the whole file.
WEB_EXPORT(void, web_begin)(double size) {
    file.bytes.emplace(static_cast<std::uint64_t>(size));
}

// Receives bytes of the file. `bytes` comes from malloc(), and the file takes ownership of it.
WEB_EXPORT(void, web_keep)(double offset, std::byte* bytes, std::size_t length) {
    file.bytes->keep(static_cast<std::uint64_t>(offset), length, JsBytes(bytes));
}

WEB_EXPORT(int, web_open)(int partial, int damaged) {
    file.options = {partial != 0, damaged != 0};
    return answer([&] { return open(); });
}

// Opens the layers after the first one. Files of one texture have none.
WEB_EXPORT(int, web_open_layers)() {
    return answer([&] { return open_further(); });
}
// Scale of the first layer, number of further layers, role and scale of each; number of lights,
// direction (3), spread and irradiance (3) of each.
WEB_EXPORT(const double*, web_layers)() {
    file.numbers = layer_facts(file.first->container().layers());
    return file.numbers.data();
}
// layer: 0, or up to the number of open further layers.
WEB_EXPORT(void, web_select)(std::uint32_t layer) {
    file.selected = layer;
}

WEB_EXPORT(const char*, web_error)() {
    return file.error.c_str();
}

// The byte ranges that the last call lacked, as pairs of offset and length. web_wanted_count() is
// the number of pairs.
WEB_EXPORT(const double*, web_wanted)() {
    file.numbers.clear();
    for (const MergedRead& read : file.bytes->wanted()) {
        file.numbers.push_back(static_cast<double>(read.offset));
        file.numbers.push_back(static_cast<double>(read.length));
    }
    return file.numbers.data();
}
WEB_EXPORT(std::size_t, web_wanted_count)() {
    return file.bytes->wanted().size();
}

WEB_EXPORT(const double*, web_facts)() {
    file.numbers = number_facts(container());
    return file.numbers.data();
}
WEB_EXPORT(const char*, web_texts)() {
    file.text = text_facts(container());
    return file.text.data();
}
WEB_EXPORT(std::size_t, web_texts_bytes)() {
    return file.text.size();
}

// Section prxy, the Draco stream of a file whose proxy is a mesh; empty for other proxies.
WEB_EXPORT(const std::byte*, web_mesh)() {
    return container().proxy_mesh().data();
}
WEB_EXPORT(std::size_t, web_mesh_bytes)() {
    return container().proxy_mesh().size();
}

WEB_EXPORT(int, web_fetch)(std::uint32_t level, const std::uint32_t* box) {
    return answer([&] { return fetch(level, box); });
}

// Writes decoded texels, in the order v, u, t, s, to web_result().
WEB_EXPORT(int, web_box)(std::uint32_t level, const std::uint32_t* corners) {
    return answer([&]() -> Status {
        TESSERA_TRY_ASSIGN(const Box4 box, checked_box(level, corners));
        TESSERA_TRY_ASSIGN(const auto out, room_for(decoder().desc().box_bytes(box)));
        return read_box(level, box, out);
    });
}

// Writes RGBA in the layout of AtlasSink to web_result(). The box must span all of s and t.
WEB_EXPORT(int, web_atlas)(std::uint32_t level, const std::uint32_t* corners) {
    return answer([&]() -> Status {
        TESSERA_TRY_ASSIGN(const Box4 box, checked_box(level, corners));
        TESSERA_TRY_ASSIGN(const auto out, room_for(box.texels() * 4));
        return read_atlas(level, box, out);
    });
}
WEB_EXPORT(const std::byte*, web_result)() {
    return file.result.get();
}

} // namespace tessera
