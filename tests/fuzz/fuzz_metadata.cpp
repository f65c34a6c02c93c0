// Section meta and the text of a description must be refused or stay the same when written and read
// again.
#include "format/container/syntax.h"
#include "tests/fuzz/fuzz_target.h"
#include "tools/support/description_text.h"
#include "tools/support/parse.h"

namespace tessera::fuzz::metadata {
namespace {

// Sets a description's field from the text "field=value".
void describe(std::string_view line) {
    const std::size_t equals = line.find('=');
    if (equals == line.npos)
        return;
    Description description;
    if (!set_description_field(description, line.substr(0, equals),
                               std::string(line.substr(equals + 1)))
             .ok())
        return;
    Description again;
    for (const auto& [field, text] : description_to_text(description))
        require(set_description_field(again, field, text).ok(), "the text of a field is refused");
    require(description_to_text(again) == description_to_text(description),
            "a description changes when read from its text");
}

} // namespace

std::vector<Bytes> seeds() {
    Metadata many;
    for (int i = 0; i < 200; ++i)
        many[std::to_string(i)] = std::string(static_cast<std::size_t>(i), 'x');
    return {*pack_metadata({{"Author", "someone"}, {"Title", "\u00e4"}}),
            *pack_metadata(many),
            bytes_of("proxy=sphere:1,2,3,4"),
            bytes_of("angular-map=octahedral hemisphere"),
            bytes_of("viewing-radius=1,2"),
            bytes_of("alpha=straight")};
}

void run(const std::uint8_t* data, std::size_t size) {
    const std::span input(reinterpret_cast<const std::byte*>(data), size);
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    describe(text);
    for (const char c : printable(std::string(text)))
        require(static_cast<unsigned char>(c) >= 32 && c != 127, "a control character is printed");
    const auto metadata = unpack_metadata(input);
    if (!metadata)
        return;
    const auto packed = pack_metadata(*metadata);
    require(packed.ok(), "metadata that were read cannot be written");
    const auto again = unpack_metadata(*packed);
    require(again.ok() && *again == *metadata, "metadata change when written again");
}

const Registered registered({.name = "fuzz_metadata", .seeds = seeds, .run = run});

} // namespace tessera::fuzz::metadata
