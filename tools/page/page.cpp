#include "tools/page/page.h"

#include "decoder_glsl/shader_source.h"
#include "tools/page/gzip.h"
#include "tools/support/html_text.h"
#include "tools/web/web_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

namespace tessera {
namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// The line without a comment at its end. Quoted text may contain the same characters.
std::string_view without_trailing_comment(std::string_view line) {
    const std::size_t at = line.find(" // ");
    if (at == line.npos)
        return line;
    const std::string_view code = line.substr(0, at);
    for (const char quote : {'\'', '"', '`'})
        if (std::ranges::count(code, quote) % 2 != 0)
            return line;
    return code.substr(0, code.find_last_not_of(' ') + 1);
}

// Removes comments and indentation, which browsers do not need.
std::string without_comments(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
        std::string_view line = text.substr(0, end);
        text.remove_prefix(end);
        line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
        if (line.starts_with("//") || line == "\n")
            continue;
        if (line.ends_with('\n'))
            line.remove_suffix(1);
        out.append(without_trailing_comment(line)).push_back('\n');
    }
    return out;
}

std::string css(const glm::dvec3& colour) {
    std::string text = "rgb(";
    for (glm::length_t i = 0; i < 3; ++i)
        text += std::to_string(static_cast<int>(std::clamp(colour[i], 0.0, 1.0) * 255 + 0.5)) +
                (i < 2 ? "," : ")");
    return text;
}

// Appends a script element that contains what append_text() appends.
template <class AppendText>
Status append_script(const char* id, const PageSink& append, const AppendText& append_text) {
    TESSERA_TRY(append(std::string("<script type=\"text/plain\" id=\"") + id + "\">"));
    TESSERA_TRY(append_text());
    return append("</script>\n");
}

Status append_base64(ByteSource& file, const PageSink& append) {
    constexpr std::uint64_t most =
        3ull << 18; // a multiple of 3, so that the base64 of pieces can be joined
    std::vector<std::byte> piece;
    for (std::uint64_t at = 0; at < file.size(); at += piece.size()) {
        piece.resize(static_cast<std::size_t>(std::min(most, file.size() - at)));
        TESSERA_TRY(file.read(at, piece));
        TESSERA_TRY(append(base64(piece)));
    }
    return {};
}

// Files that pages fetch only where the browser has WebGPU.
bool is_for_webgpu(std::string_view name) {
    return name.starts_with("tessera_webgpu.") || name == "gpu_worker.js";
}

struct Kit {
    std::string page;                // page.html
    std::vector<std::byte> packed;   // the other files, gzip
    std::span<const std::byte> wasm; // gzip
};

// The files of the viewer. `packed` is a line of JSON with names and lengths, then the files.
Result<Kit> make_kit() {
    Kit kit;
    nlohmann::ordered_json lengths;
    std::string all;
    for (const WebFile& file : web_files()) {
        if (file.name == "page.html") {
            kit.page = without_comments(text_of(file.bytes));
        } else if (file.name == "tessera.wasm.gz") {
            kit.wasm = file.bytes;
        } else if (!is_for_webgpu(file.name)) {
            const std::string text = without_comments(text_of(file.bytes));
            lengths[std::string(file.name)] = text.size();
            all += text;
        }
    }
    if (kit.wasm.empty())
        return Status(ErrorCode::unsupported,
                      "this program was built without the decoder for browsers: install the "
                      "packages " TESSERA_WASM_PACKAGES ", and build it again");
    all = lengths.dump() + "\n" + all;
    TESSERA_TRY_ASSIGN(kit.packed, gzip(std::as_bytes(std::span(all))));
    return kit;
}

// Appends the page. put(name) appends what replaces {{name}}.
template <class Put> Status fill(std::string_view page, const PageSink& append, const Put& put) {
    for (;;) {
        const std::size_t at = page.find("{{"), end = page.find("}}", at);
        if (end == page.npos)
            return append(page);
        TESSERA_TRY(append(page.substr(0, at)));
        TESSERA_TRY(put(page.substr(at + 2, end - at - 2)));
        page.remove_prefix(end + 2);
    }
}

// A shader such as "half_predicted/texels.comp.wgsl": the folder names macros.
std::optional<ViewerPart> shader_part(std::string_view name) {
    const std::size_t slash = name.find('/');
    if (slash == name.npos || !name.ends_with(".wgsl"))
        return std::nullopt;
    const std::string_view folder = name.substr(0, slash);
    std::vector<ShaderDefine> defines;
    if (folder.starts_with("half"))
        defines.emplace_back("TSR_OUTPUT_HALF", "1");
    if (folder.ends_with("_predicted"))
        defines.emplace_back("TSR_PREDICTED_TILES", "1");
    const std::string file(name.substr(slash + 1, name.size() - slash - 6));
    auto source = shader_source(file + ".glsl", ShaderDialect::wgsl, defines);
    if (!source.ok())
        return std::nullopt;
    return ViewerPart{"text/plain", std::move(*source), false};
}

using PageValues = std::vector<std::pair<std::string_view, std::string>>;

Status append_value(const PageValues& values, std::string_view name, const PageSink& append) {
    for (const auto& [key, value] : values)
        if (key == name)
            return append(value);
    return {};
}

} // namespace

Status write_page(const PageContents& contents, const PageSink& append) {
    TESSERA_TRY_ASSIGN(const Kit kit, make_kit());
    const std::string poster =
        contents.poster.empty() ? "hidden"
                                : "src=\"data:image/png;base64," + base64(contents.poster) + "\"";
    const PageValues values = {{"title", html_text(contents.title)},
                               {"background", css(contents.background)},
                               {"poster", poster},
                               {"kit", base64(kit.packed)},
                               {"wasm", base64(kit.wasm)}};
    return fill(kit.page, append, [&](std::string_view name) -> Status {
        if (name != "inputs")
            return append_value(values, name, append);
        TESSERA_TRY(
            append_script("data", append, [&] { return append(base64(contents.view_data)); }));
        return append_script("file", append, [&] { return append_base64(*contents.file, append); });
    });
}

Result<std::string> make_server_page() {
    TESSERA_TRY_ASSIGN(const Kit kit, make_kit());
    const PageValues values = {{"title", "Tessera"},
                               {"background", "#181818"},
                               {"poster", "hidden"},
                               {"kit", base64(kit.packed)},
                               {"wasm", base64(kit.wasm)}};
    std::string page;
    const PageSink append = [&page](std::string_view piece) -> Status {
        page += piece;
        return {};
    };
    TESSERA_TRY(fill(kit.page, append,
                     [&](std::string_view name) { return append_value(values, name, append); }));
    return page;
}

std::optional<ViewerPart> viewer_part(std::string_view name) {
    if (name.starts_with("wgsl/"))
        return shader_part(name.substr(5));
    const bool is_wasm = name.ends_with(".wasm");
    const std::string stored = std::string(name) + (is_wasm ? ".gz" : "");
    for (const WebFile& file : web_files())
        if (file.name == stored && is_for_webgpu(name))
            return ViewerPart{is_wasm ? "application/wasm" : "text/javascript",
                              std::string(text_of(file.bytes)), is_wasm};
    return std::nullopt;
}

} // namespace tessera
