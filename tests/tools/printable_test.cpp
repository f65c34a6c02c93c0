// Tests how text from files is printed on terminals, and how failures of libraries are reported.
#include "corpus/exr_stream.h"
#include "tools/support/parse.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Printable, ControlsBecomeBlanks) {
    EXPECT_EQ(printable("a\x1b[31m\n\tb\x7f"), "a [31m  b ");
    EXPECT_EQ(printable("\xC2\x9B"
                        "1m"),
              "  1m"); // U+009B, "ESC ["
    EXPECT_EQ(printable("\x9B"
                        "1m"),
              " 1m");                                                     // the byte alone
    EXPECT_EQ(printable("\xC3\xA4\xE2\x82\xAC"), "\xC3\xA4\xE2\x82\xAC"); // umlaut, euro
    EXPECT_EQ(printable("\xF0\x9F\x98\x80\xC2\xA0"), "\xF0\x9F\x98\x80\xC2\xA0");
}

TEST(Printable, AThreadThatCannotStartIsNoDamagedPicture) {
    const Status status = guard_exr("x.exr", []() -> Status {
        throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
    });
    EXPECT_EQ(status.code(), ErrorCode::runtime);
    EXPECT_NE(status.message().find("thread"), std::string::npos) << status.message();
}

} // namespace
} // namespace tessera
