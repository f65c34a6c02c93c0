// Prints results that must be the same on every machine and with every compiler, one per line: the
// texels of the golden files as in their manifest, the texels of damaged copies of them, and
// encoded files as in encodings.txt. run.sh compares them.
//   same_bytes GOLDEN_FOLDER [decode|encode]   prints all results, or only one kind
//   same_bytes tests/golden encode > tests/golden/encodings.txt   writes the table again
// decode is short enough for valgrind.
#include "codec/decoder.h"
#include "tests/support/encodings.h"
#include "tests/support/fnv1a.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace tessera {
namespace {

using test::Bytes;
using test::fnv1a_64;

template <class T> T checked(Result<T> result, const std::string& of) {
    if (result)
        return std::move(*result);
    std::fprintf(stderr, "%s: %s\n", of.c_str(), result.status().message().c_str());
    std::exit(1);
}

std::uint64_t hash_of_texels(const Decoder& decoder, const std::string& of) {
    const Box4 all = Box4::whole(decoder.desc().size);
    Bytes texels(decoder.desc().box_bytes(all));
    if (const Status status = decoder.decode_box(all, texels); !status) {
        std::fprintf(stderr, "%s: %s\n", of.c_str(), status.message().c_str());
        std::exit(1);
    }
    return fnv1a_64(texels);
}

std::vector<std::string> golden_names(const std::string& folder) {
    std::ifstream manifest(folder + "/manifest.txt");
    std::vector<std::string> names;
    for (std::string name, expected; manifest >> name >> expected;)
        names.push_back(name);
    return names;
}

void decode_golden(const std::string& folder) {
    for (const std::string& name : golden_names(folder)) {
        const Decoder decoder = checked(Decoder::open_file(folder + "/" + name), name);
        std::printf("%s %llx\n", name.c_str(),
                    static_cast<unsigned long long>(hash_of_texels(decoder, name)));
    }
}

// Decodes copies with one flipped bit each. Damage that checksums detect is filled, other damage is
// decoded.
void decode_damaged(const std::string& folder, const std::string& name, int copies) {
    std::ifstream in(folder + "/" + name, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const auto bytes = std::as_bytes(std::span(text));
    test::Random random(static_cast<std::uint32_t>(bytes.size()));
    std::uint64_t hash = 0, filled = 0;
    int refused = 0;
    for (int i = 0; i < 2 * copies; ++i) {
        Bytes file(bytes.begin(), bytes.end());
        file[random() % file.size()] ^= static_cast<std::byte>(1u << random() % 8);
        const Result<Decoder> decoder = Decoder::open(wrap_memory(file), DecodeOptions{true, true});
        if (!decoder || texel_count(decoder->desc().size) > 1 << 20) {
            ++refused;
            continue;
        }
        const Box4 all = Box4::whole(decoder->desc().size);
        Bytes texels(decoder->desc().box_bytes(all));
        ReadOptions options;
        options.integrity = i % 2 == 0 ? Integrity::tile : Integrity::page;
        if (decoder->decode_box(all, texels, options))
            hash = hash * 31 + fnv1a_64(texels);
        else
            ++refused;
        filled += decoder->fill_report().texels;
    }
    std::printf("%s damaged: %llx, %d refused, %llu texels filled\n", name.c_str(),
                static_cast<unsigned long long>(hash), refused,
                static_cast<unsigned long long>(filled));
}

void encode_all() {
    for (const test::Encoding& encoding : test::encodings())
        std::printf("%s\n", checked(test::encoded_line(encoding), encoding.name).c_str());
}

} // namespace
} // namespace tessera

int main(int argc, char** argv) {
    using namespace tessera;
    const std::string only = argc == 3 ? argv[2] : "";
    if (argc < 2 || argc > 3 || (argc == 3 && only != "decode" && only != "encode"))
        return 2;
    std::setvbuf(stdout, nullptr, _IOLBF, 0); // a crash keeps the earlier lines
    if (only != "encode") {
        decode_golden(argv[1]);
        for (const std::string& name : golden_names(argv[1]))
            decode_damaged(argv[1], name, 8);
    }
    if (only != "decode")
        encode_all();
}
