#include "decoder_glsl/shader_source.h"

#include "decoder_glsl/shaders/shader_files.h"
#include "decoder_glsl/shaders/translated_shaders.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace tessera {
namespace {

std::string dialect_head(ShaderDialect dialect) {
    switch (dialect) {
    case ShaderDialect::gl450:
        return "#version 450 core\n#define TSR_GL450 1\n";
    case ShaderDialect::vulkan:
        return "#version 450\n#define TSR_VULKAN 1\n";
    default:
        break;
    }
    std::string head = "#version 310 es\n#define TSR_ES310 1\n";
    // In ES opaque types have no default precision, or a low one that would round 32-bit data.
    for (const char* type : {"float", "int"})
        head += std::string("precision highp ") + type + ";\n";
    for (const char* shape : {"sampler2D", "sampler2DArray", "image2D", "image2DArray"})
        for (const char* scalar : {"", "i", "u"})
            head += std::string("precision highp ") + scalar + shape + ";\n";
    return head;
}

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool is_free_identifier(std::string_view name) {
    return !name.empty() && is_letter(name[0]) &&
           std::all_of(name.begin(), name.end(),
                       [](char c) { return is_letter(c) || (c >= '0' && c <= '9'); }) &&
           name.find("__") == std::string_view::npos && !name.starts_with("GL_") &&
           !name.starts_with("gl_") && name != "defined";
}

Status append_defines(std::span<const ShaderDefine> defines, std::string& source) {
    for (std::size_t i = 0; i < defines.size(); ++i) {
        const auto& [name, value] = defines[i];
        if (!is_free_identifier(name))
            return {ErrorCode::bad_argument, "GLSL allows no macro named '" + name + "'"};
        // A backslash at the end would join the next line to it.
        if (value.find_first_of("\n\r\\") != std::string::npos || value.find('\0') != value.npos)
            return {ErrorCode::bad_argument,
                    "the value of macro '" + name + "' is not a single line"};
        if (std::any_of(
                defines.begin(), defines.begin() + static_cast<std::ptrdiff_t>(i),
                [&, &name = name](const ShaderDefine& other) { return other.first == name; }))
            return {ErrorCode::bad_argument, "macro '" + name + "' is defined twice"};
        source += "#define " + name + " " + value + "\n";
    }
    return {};
}

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos)
        return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// The text behind "# word" on a line, or none if the line is another directive or none.
std::optional<std::string_view> directive(std::string_view line, std::string_view word) {
    line = trimmed(line);
    if (!line.starts_with('#'))
        return std::nullopt;
    line = trimmed(line.substr(1));
    if (!line.starts_with(word) || (line.size() > word.size() && is_letter(line[word.size()])))
        return std::nullopt;
    return trimmed(line.substr(word.size()));
}

// The name in `"name"`, which a comment may follow; empty if the text is anything else.
std::string_view included_name(std::string_view text) {
    if (!text.starts_with('"'))
        return {};
    const std::size_t end = text.find('"', 1);
    if (end == std::string_view::npos)
        return {};
    const std::string_view rest = trimmed(text.substr(end + 1));
    return rest.empty() || rest.starts_with("//") ? text.substr(1, end - 1) : std::string_view();
}

class Expansion {
public:
    Expansion(std::span<const ShaderFile> files, std::string& out) : files_(files), out_(out) {}

    Status file(std::string_view name, int depth) {
        const auto found = std::find_if(files_.begin(), files_.end(),
                                        [&](const ShaderFile& file) { return file.name == name; });
        if (found == files_.end())
            return {ErrorCode::bad_argument,
                    std::string("no shader file '").append(name).append("'")};
        if (std::find(open_.begin(), open_.end(), name) != open_.end())
            return {ErrorCode::bad_argument,
                    std::string("'").append(name).append("' includes itself")};
        if (depth > max_include_depth)
            return {ErrorCode::bad_argument, "includes are nested too deeply"};
        if (std::find(done_.begin(), done_.end(), name) != done_.end())
            return {};
        done_.push_back(name);
        open_.push_back(name);
        const std::size_t source_number = done_.size(); // 0 is the head
        out_ += "// source " + std::to_string(source_number) + ": " + std::string(name) + "\n";
        out_ += line_directive(1, source_number);

        std::string_view text = found->text;
        for (int number = 1; !text.empty(); ++number) {
            const std::size_t end = text.find('\n');
            const std::string_view line = text.substr(0, end);
            text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
            const Status status = append_line(line, number, source_number, depth);
            TESSERA_TRY(status.with_context(std::string(name) + ":" + std::to_string(number)));
        }
        open_.pop_back();
        return {};
    }

private:
    static std::string line_directive(int line, std::size_t source_number) {
        return "#line " + std::to_string(line) + " " + std::to_string(source_number) + "\n";
    }

    Status append_line(std::string_view line, int number, std::size_t source_number, int depth) {
        if (directive(line, "version"))
            return {ErrorCode::bad_argument,
                    "a shader file has no #version line, shader_source adds it"};
        const auto argument = directive(line, "include");
        if (!argument) {
            out_.append(line.ends_with('\r') ? line.substr(0, line.size() - 1) : line);
            out_ += '\n';
            return {};
        }
        const std::string_view name = included_name(*argument);
        if (name.empty())
            return {ErrorCode::bad_argument, "an include is written #include \"file.glsl\""};
        TESSERA_TRY(file(name, depth + 1));
        out_ += line_directive(number + 1, source_number);
        return {};
    }

    std::span<const ShaderFile> files_;
    std::string& out_;
    std::vector<std::string_view> done_; // at index S - 1: the file of source string S
    std::vector<std::string_view> open_;
};

} // namespace

Result<std::string> shader_source(std::span<const ShaderFile> files, std::string_view name,
                                  ShaderDialect dialect, std::span<const ShaderDefine> defines) {
    std::string source = dialect_head(dialect);
    TESSERA_TRY(append_defines(defines, source));
    TESSERA_TRY(Expansion(files, source).file(name, 1));
    return source;
}

Result<std::string> shader_source(std::string_view name, ShaderDialect dialect,
                                  std::span<const ShaderDefine> defines) {
    if (is_translated(dialect))
        return translated_shader(name, dialect, defines);
    return shader_source(shader_files(), name, dialect, defines);
}

std::vector<std::string_view> shader_names(ShaderDialect dialect) {
    if (is_translated(dialect))
        return translated_names(dialect);
    std::vector<std::string_view> names;
    for (const ShaderFile& file : shader_files())
        if (file.name.ends_with(".comp.glsl") || file.name.ends_with(".frag.glsl") ||
            file.name.ends_with(".vert.glsl") || file.name == "sample.glsl")
            names.push_back(file.name);
    return names;
}

} // namespace tessera
