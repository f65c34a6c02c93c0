// Letters of 3 x 5 pixels for labels on pictures.
#pragma once

#include <cstdint>

namespace tessera {

// Five rows of three bits, the top row first, each an octal digit; capitals, digits and some signs.
// Letters of either case; anything unknown is a blank.
inline const char* tiny_glyph(char c) {
    static const char* const letters[] = {
        "25755", "65656", "34443", "65556", "74647", "74644", "34553", "55755", "72227",
        "11152", "55655", "44447", "57755", "65555", "25552", "65644", "25563", "65655",
        "34216", "72222", "55557", "55552", "55775", "55255", "55222", "71247"};
    static const char* const digits[] = {"75557", "26227", "71747", "71317", "55711",
                                         "74717", "74757", "71122", "75757", "75717"};
    if (c >= 'a' && c <= 'z')
        return letters[c - 'a'];
    if (c >= 'A' && c <= 'Z')
        return letters[c - 'A'];
    if (c >= '0' && c <= '9')
        return digits[c - '0'];
    switch (c) {
    case '.':
        return "00002";
    case ',':
        return "00024";
    case ':':
        return "02020";
    case '-':
        return "00700";
    case '_':
        return "00007";
    case '=':
        return "07070";
    case '/':
        return "11244";
    default:
        return "00000";
    }
}

} // namespace tessera
