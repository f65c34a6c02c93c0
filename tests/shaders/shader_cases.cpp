// shader_cases FILE OUT: writes what dawn.mjs needs to run the shaders on a file, and what the CPU
// says that they give. OUT is a list of arrays (case_file.h).
//   facts       see write_facts(); `batch` likewise
//   tables, words             buffers 0 and 1 of the decoder
//   pixels, painted           of each batch: one tile per layer, and 1 where a texel is
//   texture, cache_words      all texels and their mips side by side; the sampler's words for a
//   plain_words, jobs         cache of one tile per layer and for `texture`; the jobs of mips.comp
//   probes                    twelve words each: centre or normal, direction, tangent, uv and
//                             footprint, and after all of these the four values that each gives
#include "codec/decoder.h"
#include "decoder_glsl/batch/decode_batch.h"
#include "tests/shaders/case_file.h"
#include "tools/view/seen_texels.h"

#include <algorithm>
#include <cstring>
#include <glm/glm.hpp>
#include <random>

namespace tessera {
namespace {

using namespace layout;
struct Case {
    const Decoder& decoder;
    const ContainerReader& reader = decoder.container();
    const TileGrid& grid = reader.grid();
    bool half = reader.desc().type == SampleType::half16;
    Extent4 most = grid.tile_extent(); // the largest tile
    std::uint32_t width = most[axis_u] * most[axis_s], height = most[axis_v] * most[axis_t];
};

// Pixels of four samples: of a layer for each tile of the batch.
void add_pixels(const Case& c, const DecodeBatch& batch, Arrays& out) {
    const std::size_t pixel = c.half ? 8 : 4;
    const std::size_t layer = std::size_t{c.width} * c.height;
    std::vector<std::byte> pixels(layer * batch.tiles.size() * pixel);
    Words painted(layer * batch.tiles.size());
    for (std::size_t i = 0; i < batch.tiles.size(); ++i) {
        const Box4 box = c.grid.box(batch.tiles[i]);
        std::vector<std::byte> texels(c.reader.desc().box_bytes(box));
        must(c.decoder.decode_grid_box(box, texels, {}));
        // put_pixels() has no gaps between angular images, which smaller tiles have here.
        const Extent4 n = box.extent();
        std::vector<std::byte> dense(box.texels() * pixel);
        put_pixels(c.reader.desc(), box, texels, n[axis_u] * n[axis_s], dense);
        for (std::uint32_t y = 0; y < n[axis_v] * n[axis_t]; ++y)
            for (std::uint32_t x = 0; x < n[axis_u] * n[axis_s]; ++x) {
                const std::size_t to = i * layer +
                                       (y / n[axis_t] * c.most[axis_t] + y % n[axis_t]) * c.width +
                                       x / n[axis_s] * c.most[axis_s] + x % n[axis_s];
                std::memcpy(&pixels[to * pixel],
                            &dense[(std::size_t{y} * n[axis_u] * n[axis_s] + x) * pixel], pixel);
                painted[to] = 1;
            }
    }
    out.add("pixels", pixels);
    out.add("painted", painted);
}

void add_decoding(const Case& c, Arrays& out) {
    auto tables = must(DecodeTables::make(c.reader, ScanMemory::unbounded));
    TexelPlan plan;
    plan.stride_s = c.most[axis_s];
    plan.stride_t = c.most[axis_t];
    BatchBuilder builder(tables, c.grid, {.tiles = 256}, plan);
    std::vector<DecodeBatch> batches;
    std::uint32_t layer = 0;
    for (std::uint64_t tile = 0; tile < c.grid.tiles(); ++tile) {
        const auto loaded = must(c.reader.load_tile(tile));
        if (!builder.add(tile, loaded.bytes, {.layer = layer})) {
            batches.push_back(builder.finish());
            layer = 0;
            builder.add(tile, loaded.bytes, {.layer = layer});
        }
        ++layer;
    }
    batches.push_back(builder.finish());
    out.add("facts", Words{c.half, tables.filters(), tables.keeps_values(), c.width, c.height,
                           static_cast<std::uint32_t>(batches.size()), c.reader.desc().channels});
    out.add("tables", std::as_bytes(tables.words()));
    for (const DecodeBatch& b : batches) {
        out.add("batch",
                Words{static_cast<std::uint32_t>(b.tiles.size()), b.most_segments, b.raw_chunks,
                      b.corrections, b.waves, b.most_texels, b.predicted, b.borders,
                      static_cast<std::uint32_t>(b.work_words),
                      static_cast<std::uint32_t>(std::max<std::uint64_t>(b.coefficients, 1))});
        out.add("words", b.words);
        add_pixels(c, b, out);
    }
}

// Two charts, the left and the right half of the atlas.
SurfaceMesh two_charts() {
    SurfaceMesh mesh;
    for (const float left : {0.02f, 0.53f}) {
        const auto first = static_cast<std::uint32_t>(mesh.uv.size());
        for (const glm::vec2 corner :
             {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
            mesh.uv.emplace_back(left + 0.45f * corner.x, 0.02f + 0.96f * corner.y);
            mesh.positions.emplace_back(mesh.uv.back(), 0.0f);
            mesh.normals.emplace_back(0.0f, 0.0f, 1.0f);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    return mesh;
}

// The texels of a source in memory.
struct Texels : TexelLookup {
    TextureDesc description;
    std::vector<std::byte> bytes;

    const std::byte* at(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t) const {
        const auto& n = description.size;
        return &bytes[(((std::size_t{v} * n[0] + u) * n[3] + t) * n[2] + s) *
                      description.texel_bytes()];
    }
    const TextureDesc& desc() const override { return description; }
    Result<glm::dvec4> texel(std::uint32_t u, std::uint32_t v, std::uint32_t s,
                             std::uint32_t t) override {
        return texel_value(description, at(u, v, s, t));
    }
};

// The sampler's words for a cache of one tile per layer.
Words cache_words(const Case& c, AngularMap map) {
    Words words = sampler_header(c.grid, map, c.most);
    for (const std::size_t axis : {axis_u, axis_v}) {
        words[tsr_p_axis_at + axis] = static_cast<std::uint32_t>(words.size());
        Extent4 tile{0, 0, 0, 0};
        for (; tile[axis] < c.grid.count()[axis]; ++tile[axis]) {
            const std::uint32_t extent = c.grid.box(tile).extent()[axis];
            const std::uint32_t longer = extent > c.grid.size()[axis] / c.grid.count()[axis];
            for (std::uint32_t x = 0; x < extent; ++x)
                words.push_back(tile[axis] | (x << tsr_axis_place_at) |
                                (longer << tsr_axis_longer_at));
        }
    }
    words[tsr_p_slot_width] = words[tsr_p_width] = c.width;
    words[tsr_p_slot_height] = words[tsr_p_height] = c.height;
    words[tsr_p_page_at] = static_cast<std::uint32_t>(words.size());
    for (std::uint32_t tile = 0; tile < c.grid.tiles(); ++tile)
        words.push_back(tile << tsr_page_layer_at);
    return words;
}

Words mip_jobs(const Case& c) {
    Words jobs;
    for (std::uint64_t tile = 0; tile < c.grid.tiles(); ++tile) {
        const Box4 box = c.grid.box(tile);
        const Extent4 n = box.extent();
        jobs.insert(jobs.end(), {0, box.begin[0], box.begin[1], n[0] | (n[1] << 16),
                                 box.begin[2] | (box.begin[3] << 16), n[2] | (n[3] << 16), 0, 0});
    }
    return jobs;
}

void add_sampling(const Case& c, Arrays& out) {
    const AngularMap map = AngularMap::octahedral_mirrored;
    const AtlasMips mips(two_charts(), c.grid);
    const auto source = decoded_source(c.decoder);
    const auto with_mips = make_mip_source(*source, mips, c.grid.tile_extent()[axis_v]);
    Texels texels;
    texels.description = with_mips->desc();
    texels.bytes = all_texels(*with_mips);
    out.add("texture", all_pixels(texels.description, texels.bytes));
    Words plain = plain_words(c.grid, mips, map), cached = cache_words(c, map);
    for (Words* words : {&plain, &cached}) {
        (*words)[tsr_p_half] = c.half;
        (*words)[tsr_p_inside] = c.reader.description().proxy == Proxy::sphere_inside;
    }
    out.add("plain_words", plain);
    out.add("cache_words", cached);
    out.add("jobs", mip_jobs(c));

    // Spheres have no mips beside them.
    Texels sphere;
    sphere.description = c.reader.desc();
    sphere.bytes = all_texels(*source);

    std::mt19937 random(1);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    const auto vector = [&] {
        return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    };
    constexpr int count = 4096;
    std::vector<float> probes, values;
    const auto put = [](std::vector<float>& to, std::initializer_list<float> more) {
        to.insert(to.end(), more);
    };
    for (int i = 0; i < count; ++i) {
        const glm::vec3 n = vector(), tangent = vector();
        glm::vec3 d = vector();
        const bool inside = c.reader.description().proxy == Proxy::sphere_inside;
        if ((glm::dot(n, d) < 0) != inside)
            d = -d;
        const glm::vec2 uv(uniform(random), uniform(random));
        const glm::vec2 footprint = std::exp2(4.0f * uniform(random)) *
                                    glm::vec2(0.5f + uniform(random), 0.5f + uniform(random));
        put(probes, {n.x, n.y, n.z, 0, d.x, d.y, d.z, 0, tangent.x, tangent.y, tangent.z, 0, uv.x,
                     uv.y, footprint.x, footprint.y});
        const auto on_sphere =
            must(sample(sphere, glm::dvec3(n), glm::dvec3(d), c.reader.description().proxy));
        SurfaceFrame frame;
        frame.ez = n;
        frame.ex = glm::normalize(glm::dvec3(tangent) -
                                  glm::dot(frame.ez, glm::dvec3(tangent)) * frame.ez);
        frame.ey = glm::cross(frame.ez, frame.ex);
        const glm::dvec2 st = octahedral_place(map, frame, d);
        const glm::dvec2 covered =
            glm::dvec2(footprint) / glm::dvec2(c.grid.size()[axis_u], c.grid.size()[axis_v]);
        for (const glm::dvec4& value :
             {on_sphere,
              must(sample(texels, texels_in_mips(mips, c.grid.size(), map, uv, st, covered))),
              must(sample(sphere, mesh_footprint(c.grid.size(), map, uv, st)))})
            for (int k = 0; k < 4; ++k)
                values.push_back(static_cast<float>(value[k]));
    }
    out.add("probes", std::as_bytes(std::span(probes)));
    out.add("values", std::as_bytes(std::span(values))); // sphere, plain surface, cached surface
}

int run(const char* path, const char* to) {
    const Decoder decoder = must(Decoder::open_file(path));
    const Case c{decoder};
    Arrays out(to);
    add_decoding(c, out);
    // Camera views are not a texture of a surface, and a layer of 2,048 tiles is the most.
    if (!c.reader.alignment().any() && c.grid.tiles() <= 256)
        add_sampling(c, out);
    must(out.finish());
    return 0;
}

} // namespace
} // namespace tessera

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: shader_cases FILE OUT\n");
        return 1;
    }
    return tessera::run(argv[1], argv[2]);
}
