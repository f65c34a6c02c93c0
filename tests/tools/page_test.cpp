#include "tools/page/gzip.h"
#include "tools/page/page.h"

#include <gtest/gtest.h>
#include <zlib.h>

namespace tessera {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text));
}

std::string unpacked(std::span<const std::byte> packed, std::size_t length) {
    std::string out(length + 1, '?'); // one more would be noticed
    z_stream stream{};
    EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(packed.data()));
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    inflateEnd(&stream);
    return out;
}

TEST(Gzip, ComesBackWhateverTheLength) {
    std::string text;
    for (const std::size_t length : {0u, 1u, 70'000u, 300'000u}) {
        while (text.size() < length)
            text += static_cast<char>(text.size() * text.size() >> 7);
        const auto packed = gzip(bytes_of(text));
        ASSERT_TRUE(packed.ok());
        EXPECT_EQ(unpacked(*packed, text.size()), text);
        EXPECT_EQ(*packed, *gzip(bytes_of(text)));
    }
}

TEST(Base64, IsThatOfRfc4648) {
    const std::pair<const char*, const char*> vectors[] = {
        {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}};
    for (const auto& [text, coded] : vectors)
        EXPECT_EQ(base64(bytes_of(text)), coded);
    EXPECT_EQ(base64(std::vector{std::byte{0xFB}, std::byte{0xFF}, std::byte{0xFE}}), "+//+");
}

TEST(Page, HoldsWhatItIsGivenAndNothingElse) {
    PageContents contents;
    contents.title = "<b>&\"";
    contents.background = {1, 0.5, 0};
    const std::string file = "the file", data = "the data";
    contents.file = bytes_of(file);
    contents.view_data.assign(bytes_of(data).begin(), bytes_of(data).end());
    const auto page = make_page(contents);
    if (!page.ok()) { // built without a compiler for wasm
        EXPECT_EQ(page.status().code(), ErrorCode::unsupported);
        EXPECT_NE(page.status().message().find("clang-19"), std::string::npos);
        return;
    }
    for (const char* part :
         {"<title>&lt;b&gt;&amp;&quot;</title>", "background: rgb(255,128,0)",
          "id=\"file\">dGhlIGZpbGU=<", "id=\"data\">dGhlIGRhdGE=<", "id=\"kit\">H4sI"})
        EXPECT_NE(page->find(part), page->npos) << part;
    EXPECT_EQ(page->find("{{"), page->npos);
    // The budget of viewer and decoder.
    const auto server = make_server_page();
    ASSERT_TRUE(server.ok());
    EXPECT_LT(server->size(), 200'000u);
    EXPECT_EQ(server->find("id=\"file\""), server->npos);
}

} // namespace
} // namespace tessera
