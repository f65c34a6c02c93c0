#include "decoder_glsl/shaders/translated_shaders.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <zstd.h>

namespace tessera {
namespace {

constexpr std::array<std::pair<ShaderDialect, std::string_view>, 3> translated_dialects = {
    {{ShaderDialect::hlsl, "hlsl"}, {ShaderDialect::msl, "msl"}, {ShaderDialect::wgsl, "wgsl"}}};

using Macros = std::set<std::string_view>;

// The translations of a program into one dialect.
struct TranslatedProgram {
    Macros macros; // all that change it
    std::map<Macros, std::string_view> texts;
};

struct Translations {
    std::string joined; // which all views refer to
    std::map<std::pair<std::string_view, std::string_view>, TranslatedProgram>
        programs;  // by dialect and name
    Macros macros; // of all programs
};

std::string unpacked(std::span<const std::byte> packed) {
    std::string text(ZSTD_getFrameContentSize(packed.data(), packed.size()), '\0');
    const std::size_t size =
        ZSTD_decompress(text.data(), text.size(), packed.data(), packed.size());
    text.resize(ZSTD_isError(size) != 0 ? 0 : size);
    return text;
}

// Removes the beginning of `text` up to `end`, and returns it without `end`.
std::string_view cut(std::string_view& text, char end) {
    const std::size_t at = std::min(text.find(end), text.size());
    const std::string_view part = text.substr(0, at);
    text.remove_prefix(std::min(at + 1, text.size()));
    return part;
}

Translations read_translations() {
    Translations all;
    all.joined = unpacked(packed_translations());
    for (std::string_view rest = all.joined; !rest.empty();) {
        std::string_view key = cut(rest, '\0');
        const std::string_view dialect = cut(key, ' ');
        TranslatedProgram& program = all.programs[{dialect, cut(key, ' ')}];
        Macros macros;
        while (!key.empty())
            macros.insert(cut(key, ' '));
        program.macros.insert(macros.begin(), macros.end());
        all.macros.insert(macros.begin(), macros.end());
        program.texts[std::move(macros)] = cut(rest, '\0');
    }
    return all;
}

const Translations& translations() {
    static const Translations* const all = new Translations(read_translations());
    return *all;
}

std::string_view word_of(ShaderDialect dialect) {
    const auto found = std::ranges::find(translated_dialects, dialect,
                                         &std::pair<ShaderDialect, std::string_view>::first);
    return found == translated_dialects.end() ? std::string_view() : found->second;
}

} // namespace

bool is_translated(ShaderDialect dialect) {
    return !word_of(dialect).empty();
}

Result<std::string> translated_shader(std::string_view name, ShaderDialect dialect,
                                      std::span<const ShaderDefine> defines) {
    const Translations& all = translations();
    const auto found = all.programs.find({word_of(dialect), name});
    if (found == all.programs.end())
        return Status(ErrorCode::bad_argument,
                      "no shader '" + std::string(name) + "' in " + std::string(word_of(dialect)));
    Macros chosen;
    for (const auto& [macro, value] : defines) {
        if (!all.macros.contains(macro)) {
            std::string known;
            for (const std::string_view one : all.macros)
                known.append(known.empty() ? "" : ", ").append(one);
            return Status(ErrorCode::bad_argument,
                          "the shaders in " + std::string(word_of(dialect)) + " have no macro '" +
                              macro + "', only " + known);
        }
        if (found->second.macros.contains(macro))
            chosen.insert(macro);
    }
    return std::string(found->second.texts.at(chosen));
}

std::vector<std::string_view> translated_names(ShaderDialect dialect) {
    std::vector<std::string_view> names;
    for (const auto& [key, program] : translations().programs)
        if (key.first == word_of(dialect))
            names.push_back(key.second);
    return names;
}

} // namespace tessera
