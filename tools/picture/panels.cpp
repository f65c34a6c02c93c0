#include "tools/picture/panels.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace tessera {
namespace {

constexpr std::uint32_t gap = 8, label_height = 16, font_scale = 2;

// A glyph of 3 x 5 pixels: five octal digits, a row each from the top. Small letters look like
// capitals; unknown characters are blank.
const char* tiny_glyph(char c) {
    static const char* const letters[] = {
        "25755", "65656", "34443", "65556", "74647", "74644", "34553", "55755", "72227",
        "11152", "55655", "44447", "57755", "65555", "25552", "65644", "25563", "65655",
        "34216", "72222", "55557", "55552", "55775", "55255", "55222", "71247"};
    static const char* const digits[] = {"75557", "26227", "71747", "71317", "55711",
                                         "74717", "74757", "71122", "75757", "75717"};
    static const std::pair<char, const char*> signs[] = {
        {'.', "00002"}, {',', "00024"}, {':', "02020"}, {'-', "00700"},
        {'_', "00007"}, {'=', "07070"}, {'/', "11244"}};
    if (c >= 'a' && c <= 'z')
        return letters[c - 'a'];
    if (c >= 'A' && c <= 'Z')
        return letters[c - 'A'];
    if (c >= '0' && c <= '9')
        return digits[c - '0'];
    for (const auto& [sign, rows] : signs)
        if (c == sign)
            return rows;
    return "00000";
}

void draw_text(Picture& p, std::uint32_t left, std::uint32_t top, const std::string& text) {
    for (char c : text) {
        const char* rows = tiny_glyph(c);
        for (std::uint32_t y = 0; y < 5 * font_scale; ++y)
            for (std::uint32_t x = 0; x < 3 * font_scale; ++x)
                if ((rows[y / font_scale] - '0') >> (2 - x / font_scale) & 1 &&
                    left + x < p.width && top + y < p.height)
                    std::memset(p.pixel(left + x, top + y), 220, 3);
        left += 4 * font_scale;
    }
}

} // namespace

Result<Picture> lay_out(const std::vector<PanelRow>& rows) {
    std::uint64_t width = gap, height = gap;
    for (const PanelRow& row : rows) {
        std::uint64_t across = gap, down = 0;
        for (const Panel& panel : row) {
            across += panel.picture.width + gap;
            down = std::max<std::uint64_t>(down, panel.picture.height);
        }
        width = std::max(width, across);
        height += down + label_height + gap;
    }
    if (width > max_sheet_pixels || height > max_sheet_pixels || width * height > max_sheet_pixels)
        return Status(ErrorCode::unsupported, "the sheet would be too large");
    Picture sheet =
        blank_picture(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 32);
    std::uint32_t y = gap;
    for (const PanelRow& row : rows) {
        std::uint32_t x = gap, down = 0;
        for (const auto& [label, picture] : row) {
            const std::size_t fits = picture.width / (4 * font_scale);
            draw_text(sheet, x, y, label.substr(0, std::max<std::size_t>(fits, 1)));
            for (std::uint32_t line = 0; line < picture.height; ++line)
                std::memcpy(sheet.pixel(x, y + label_height + line),
                            picture.rgb.data() + std::size_t{line} * picture.width * 3,
                            std::size_t{picture.width} * 3);
            x += picture.width + gap;
            down = std::max(down, picture.height);
        }
        y += down + label_height + gap;
    }
    return sheet;
}

} // namespace tessera
