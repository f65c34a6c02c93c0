// Finds the programs among the embedded shader files, by the convention of shader_source.h.
#pragma once

#include "decoder_glsl/shader_source.h"
#include "decoder_glsl/shaders/shader_files.h"

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::test {

struct ShaderProgram {
    std::string name;                  // "texels.comp.glsl"
    std::string stem;                  // "texels"
    std::string stage;                 // "comp", "vert" or "frag"
    std::vector<ShaderDefine> defines; // of this variant

    std::string label() const { return defines.empty() ? name : name + " " + defines[0].first; }
};

// The names that follow `word` at the start of a line.
inline std::set<std::string> names_after(std::string_view text, std::string_view word) {
    std::set<std::string> names;
    for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
        if (at != 0 && text[at - 1] != '\n')
            continue;
        const std::size_t first = at + word.size();
        names.emplace(text.substr(first, text.find_first_of(" \t\r\n(", first) - first));
    }
    return names;
}

// The combinations of sample.glsl's switches.
inline std::vector<std::vector<ShaderDefine>> sampling_variants() {
    const ShaderDefine filter{"TESSERA_HARDWARE_FILTER", "1"};
    const ShaderDefine cache{"TESSERA_RESIDENT_CACHE", "1"};
    return {{filter}, {cache}, {cache, filter}};
}

// Every program, and one variant for each switch that only the host sets: a macro that the program
// tests with #ifdef and that no file defines.
inline std::vector<ShaderProgram> shader_programs() {
    std::set<std::string> defined = {"__cplusplus", "TSR_GL450", "TSR_ES310", "TSR_VULKAN",
                                     "TSR_TRANSLATED"};
    for (const ShaderFile& file : shader_files())
        defined.merge(names_after(file.text, "#define "));
    std::vector<ShaderProgram> programs;
    for (const ShaderFile& file : shader_files())
        for (const char* stage : {"comp", "vert", "frag"}) {
            const std::string ending = std::string(".") + stage + ".glsl";
            if (!file.name.ends_with(ending))
                continue;
            const std::string name(file.name);
            const std::string stem = name.substr(0, name.size() - ending.size());
            programs.push_back({name, stem, stage, {}});
            for (const std::string& macro : names_after(file.text, "#ifdef "))
                if (!defined.contains(macro))
                    programs.push_back({name, stem, stage, {{macro, "1"}}});
            if (names_after(file.text, "#include ").contains("\"sample.glsl\""))
                for (const auto& variant : sampling_variants())
                    programs.push_back({name, stem, stage, variant});
        }
    return programs;
}

} // namespace tessera::test
