// The C++ version of ../main.c.
#include <tessera/codec/decoder.h>

#include <cstdio>
#include <vector>

int main() {
    using namespace tessera;
    const auto decoder = Decoder::open_file(DECODED);
    const Box4 all = decoder ? Box4::whole(decoder->desc().size) : Box4{};
    std::vector<std::byte> texels(decoder ? decoder->desc().box_bytes(all) : 0);
    const Status status = decoder ? decoder->decode_box(all, texels) : decoder.status();
    if (!status.ok())
        std::fprintf(stderr, "%s\n", status.message().c_str());
    return status.ok() && !texels.empty() ? 0 : 1;
}
