// A whole file is validated and opened, and parts of it are decoded.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "format/container_reader.h"
#include "tests/fuzz/container_mend.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"

namespace tessera::fuzz::container {
namespace {

// The texels of aligned views must equal those at their positions in the grid.
void check_places(const Decoder& decoder, const Box4& box, const Bytes& texels) {
    const AlignedViews views = decoder.container().aligned_views();
    const Box4 whole = Box4::whole(views.grid_size());
    const std::uint64_t bytes = decoder.desc().box_bytes(whole);
    if (!views.any() || bytes > 1u << 16)
        return;
    Bytes grid(static_cast<std::size_t>(bytes)), expected(texels.size());
    if (!decoder.decode_grid_box(whole, grid, {1, Integrity::page, {}, {}}))
        return;
    views.copy_from_grid(whole, grid, box, expected, decoder.desc().texel_bytes());
    require(texels == expected, "aligned views and their grid have different texels");
}

void read_box(const Decoder& decoder, const Box4& box) {
    Bytes texels(decoder.desc().box_bytes(box));
    (void)decoder.decode_box(box, texels, {.threads = 1, .integrity = Integrity::tile});
    if (decoder.decode_box(box, texels, {.threads = 1, .integrity = Integrity::page}))
        check_places(decoder, box, texels);
}

void read_everything(ByteSource& source) {
    const std::vector<Finding> findings = validate_container(source);
    const Result<ContainerReader> container = ContainerReader::open(source);
    if (!container) {
        require(!findings.empty(), "a file that cannot be opened has no findings");
        return;
    }
    for (std::uint32_t group = 0; group < std::min(container->group_count(), 8u); ++group)
        (void)container->group(group);
    for (const LayerInfo& layer : container->layers().further)
        read_everything(*layer_bytes(source, layer));
    const Result<Decoder> decoder = Decoder::open(source);
    if (!decoder)
        return;
    Box4 box = Box4::whole(decoder->desc().size);
    for (std::uint32_t& end : box.end)
        end = std::min(end, 12u);
    read_box(*decoder, box);
    if (!decoder->container().alignment().any())
        return;
    box = Box4::whole(decoder->desc().size);
    for (std::size_t axis = 0; axis < 4; ++axis)
        box.begin[axis] = box.end[axis] - std::min(box.end[axis], 4u);
    read_box(*decoder, box);
}

// A file whose views may be aligned by up to 12 and 30 texels.
Bytes far_aligned_seed() {
    test::MemoryTexture texture =
        test::named_texture({{25, 31, 3, 2}, SampleType::unorm8, 3}, "smooth");
    EncodeOptions options;
    options.tile_extent = {16, 16, 2, 2};
    options.threads = 1;
    options.effort = 0;
    Bytes file;
    require(encode_memory(texture, file, options).ok(), "a seed does not encode");
    return test::with_alignment(file, {-9, 13});
}

// A file with a layer of specular colour, one of reflections, and a light.
Bytes layered_seed() {
    const auto encoded = [](const Extent4& size, AngularMap map) {
        test::MemoryTexture texture = test::named_texture({size, SampleType::unorm8, 3}, "smooth");
        EncodeOptions options;
        options.tile_extent = {8, 8, 2, 2};
        options.threads = 1;
        options.effort = 0;
        options.description.angular_map = map;
        Bytes file;
        require(encode_memory(texture, file, options).ok(), "a seed does not encode");
        return file;
    };
    const Bytes first = encoded({9, 8, 1, 1}, AngularMap::none),
                second = encoded({5, 4, 1, 1}, AngularMap::none),
                third = encoded({3, 2, 2, 2}, AngularMap::octahedral_mirrored);
    const std::vector<LayerFile> further{{LayerRole::specular, 1.0f, second},
                                         {LayerRole::reflection, 2.0f, third}};
    const std::vector<DistantLight> lights(1);
    const auto file = join_layers(first, 1.0f, further, lights);
    require(file.ok(), "the layers of a seed do not fit");
    return *file;
}

} // namespace

void mend(Bytes& file) {
    mend_container(file);
}

void alter(Bytes& file, unsigned random) {
    align_views(file, random);
}

std::vector<Bytes> seeds() {
    std::vector<Bytes> all;
    for (const int channels : {1, 3, 4}) {
        const TextureDesc desc{{9, 6, 5, 4},
                               channels == 4 ? SampleType::half16 : SampleType::unorm8,
                               static_cast<std::uint8_t>(channels)};
        test::MemoryTexture texture = test::named_texture(desc, "smooth");
        EncodeOptions options;
        options.tile_extent = {5, 6, 3, 4};
        options.threads = 1;
        options.rate = channels == 3 ? RateTarget{RateTarget::Kind::max_error, 4}
                                     : RateTarget{RateTarget::Kind::quality, 40};
        options.metadata = {{"Author", "someone"}};
        Bytes file;
        require(encode_memory(texture, file, options).ok(), "a seed does not encode");
        all.push_back(file);
        if (channels == 1)
            all.push_back(test::with_alignment(file, {-2, 1}));
    }
    all.push_back(far_aligned_seed());
    all.push_back(layered_seed());
    return all;
}

void run(const std::uint8_t* data, std::size_t size) {
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    read_everything(*wrap_memory({bytes, size}));
}

const Registered registered(
    {.name = "fuzz_container", .seeds = seeds, .run = run, .mend = mend, .alter = alter});

} // namespace tessera::fuzz::container
