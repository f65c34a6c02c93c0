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
    std::string out(length + 1, '?'); // one byte more, to detect a longer text
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

TEST(Gzip, RoundTripsTextOfAnyLength) {
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

TEST(Base64, FollowsRfc4648) {
    const std::pair<const char*, const char*> vectors[] = {
        {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}};
    for (const auto& [text, coded] : vectors)
        EXPECT_EQ(base64(bytes_of(text)), coded);
    EXPECT_EQ(base64(std::vector{std::byte{0xFB}, std::byte{0xFF}, std::byte{0xFE}}), "+//+");
}

TEST(Page, HoldsOnlyTheGivenContents) {
    PageContents contents;
    contents.title = "<b>&\"";
    contents.background = {1, 0.5, 0};
    // Longer than the pieces in which it is written.
    const std::string file = "the file" + std::string(3 << 20, 'x'), data = "the data";
    const auto source = wrap_memory(bytes_of(file));
    contents.file = source.get();
    contents.view_data.assign(bytes_of(data).begin(), bytes_of(data).end());
    std::string page;
    std::size_t largest = 0;
    const Status written = write_page(contents, [&](std::string_view piece) -> Status {
        page += piece;
        largest = std::max(largest, piece.size());
        return {};
    });
    if (!written.ok()) { // built without a WebAssembly compiler
        EXPECT_EQ(written.code(), ErrorCode::unsupported);
        EXPECT_NE(written.message().find("clang-19"), std::string::npos);
        EXPECT_EQ(page, "");
        return;
    }
    EXPECT_LT(largest, file.size() / 2);
    EXPECT_NE(page.find("id=\"file\">" + base64(bytes_of(file)) + "<"), page.npos);
    for (const char* part : {"<title>&lt;b&gt;&amp;&quot;</title>", "background: rgb(255,128,0)",
                             "id=\"data\">dGhlIGRhdGE=<", "id=\"kit\">H4sI"})
        EXPECT_NE(page.find(part), page.npos) << part;
    EXPECT_EQ(page.find("{{"), page.npos);
    // An error of the callback ends the writing.
    const Status stopped =
        write_page(contents, [](std::string_view) { return Status(ErrorCode::io, "disk full"); });
    EXPECT_EQ(stopped.message(), "disk full");
    // The size budget of viewer and decoder.
    const auto server = make_server_page();
    ASSERT_TRUE(server.ok());
    EXPECT_LT(server->size(), 220'000u);
    EXPECT_EQ(server->find("id=\"file\""), server->npos);
}

// What pages fetch where the browser has WebGPU.
TEST(Page, HasPartsForWebGpu) {
    if (!make_server_page().ok())
        GTEST_SKIP() << "built without a WebAssembly compiler";
    const auto worker = viewer_part("gpu_worker.js"), wasm = viewer_part("tessera_webgpu.wasm");
    ASSERT_TRUE(worker && wasm);
    EXPECT_EQ(worker->type, "text/javascript");
    EXPECT_TRUE(wasm->is_gzip);
    const auto plain = viewer_part("wgsl/plain/texels.comp.wgsl"),
               half = viewer_part("wgsl/half_predicted/texels.comp.wgsl");
    ASSERT_TRUE(plain && half);
    EXPECT_NE(plain->content.find("rgba8unorm, write"), std::string::npos);
    EXPECT_NE(half->content.find("rgba16float, write"), std::string::npos);
    for (const char* name : {"", "page.html", "tessera.js", "wgsl/tree.comp.wgsl",
                             "wgsl/plain/tree.comp", "wgsl/plain/nothing.wgsl", "../gpu_worker.js"})
        EXPECT_FALSE(viewer_part(name)) << name;
}

} // namespace
} // namespace tessera
