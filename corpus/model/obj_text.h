// What the readers of .obj and .mtl files share.
#pragma once

#include "corpus/model/text_lines.h"
#include "corpus/model/utf16_text.h"
#include "format/output_file.h"
#include "format/status.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace tessera::corpus {

inline Status wrong_line(const LineReader& lines, const std::string& what) {
    return {ErrorCode::invalid_file, "line " + std::to_string(lines.number()) + ": " + what};
}

inline std::string_view text_of(const std::vector<unsigned char>& bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return text.substr(text.starts_with("\xEF\xBB\xBF") ? 3 : 0); // a byte order mark
}

// The next line, joined with the lines below it as long as it ends with a backslash. `joined` holds
// the text of joined lines.
inline std::string_view next_statement(LineReader& lines, std::string& joined) {
    std::string_view line = lines.next();
    if (!line.ends_with('\\'))
        return line;
    joined.clear();
    for (; line.ends_with('\\'); line = lines.next())
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
    return joined.append(line);
}

// Some exporters write a decimal comma.
inline bool parse_real(std::string_view word, double& number) {
    std::string text(word);
    std::replace(text.begin(), text.end(), ',', '.');
    return parse_word(text, number);
}

// Exporters on Windows write backslashes.
inline std::string with_slashes(std::string_view path) {
    std::string text(path);
    std::replace(text.begin(), text.end(), '\\', '/');
    return text;
}

inline bool is_there(const std::string& path) {
    std::error_code error;
    return std::filesystem::exists(to_path(path), error);
}

} // namespace tessera::corpus
