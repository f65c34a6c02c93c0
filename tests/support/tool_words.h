// Encodes with coding tools switched by name.
#pragma once

#include "codec/encode/encode_with_tools.h"
#include "codec/encoder.h"
#include "codec/tile_encoder/tool_switches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

namespace tessera::test {

// "-copies,+grids" switches copies off and grids on; "none" and "all" mean every tool. Later words
// win.
inline ToolSwitches tool_switches(const std::string& words) {
    ToolSwitches switches;
    std::istringstream in(words);
    for (std::string word; std::getline(in, word, ',');) {
        const auto name = std::ranges::find(coding_tool_names, word.substr(1));
        if (word == "none" || word == "all")
            switches.set_all(word == "all");
        else if (name == coding_tool_names.end() || (word[0] != '+' && word[0] != '-'))
            ADD_FAILURE() << "'" << word << "' switches no coding tool";
        else
            switches.set(static_cast<CodingTool>(name - coding_tool_names.begin()), word[0] == '+');
    }
    return switches;
}

struct SwitchedOptions : EncodeOptions {
    SwitchedOptions(const EncodeOptions& options = {}, std::string words = {})
        : EncodeOptions(options), tools(std::move(words)) {}
    std::string tools; // as tool_switches() reads them
};

inline Result<EncodeReport> encode_memory(TexelSource& source, std::vector<std::byte>& out,
                                          const SwitchedOptions& options) {
    return tessera::encode_memory(source, out, options, tool_switches(options.tools));
}

} // namespace tessera::test
