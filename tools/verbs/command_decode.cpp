#include "codec/decoder.h"
#include "tools/http/open_bytes.h"
#include "tools/support/fill_text.h"
#include "tools/support/interrupt.h"
#include "tools/support/memory_budget.h"
#include "tools/support/progress.h"
#include "tools/support/standard_streams.h"
#include "tools/support/texture_arguments.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"
#include "tools/view/layer_files.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>

namespace tessera {
namespace {

struct DecodeCommand {
    std::string input, output, layer, box, memory;
    TextureArguments texture; // threads and quiet
    bool json = false;
};

// Shifts boxes of the whole texture to their positions in the part that is written.
class PartSink : public TexelSink {
public:
    PartSink(std::unique_ptr<TexelSink> inner, const Extent4& origin)
        : inner_(std::move(inner)), origin_(origin) {}
    Locality locality() const override { return inner_->locality(); }
    Status begin_slab(const Box4& box) override { return inner_->begin_slab(moved(box)); }
    Status write(const Box4& box, std::span<const std::byte> texels) override {
        return inner_->write(moved(box), texels);
    }
    Status end_slab() override { return inner_->end_slab(); }
    Status finish() override { return inner_->finish(); }

private:
    Box4 moved(Box4 box) const {
        for (std::size_t axis = 0; axis < 4; ++axis) {
            box.begin[axis] -= origin_[axis];
            box.end[axis] -= origin_[axis];
        }
        return box;
    }
    std::unique_ptr<TexelSink> inner_;
    Extent4 origin_;
};

// A picture is held in memory as a whole, beside the slabs.
Status hold_picture(const std::string& path, std::uint64_t bytes, std::uint64_t& slab_bytes) {
    if (bytes > slab_bytes / 2)
        return {ErrorCode::over_budget, path + ": the picture's " + std::to_string(bytes) +
                                            " bytes must be held in memory, but only " +
                                            std::to_string(slab_bytes / 2) +
                                            " are allowed (.exr and views/ are written in parts)"};
    slab_bytes -= bytes;
    return {};
}

Status decode_into(const DecodeCommand& a, const Decoder& decoder, const Box4& box) {
    TESSERA_TRY_ASSIGN(auto slab_bytes, slab_budget(a.memory, a.texture.threads));
    TextureDesc desc = decoder.desc();
    desc.size = box.extent();
    if (kind_of(a.output) == TextureKind::picture)
        TESSERA_TRY(with_memory_hint(
            hold_picture(a.output, desc.box_bytes(Box4::whole(desc.size)), slab_bytes)));
    TESSERA_TRY_ASSIGN(const auto asked, make_view_hints(a.texture));
    const ContainerReader& file = decoder.container();
    ViewLayout layout = layout_for(asked, file.metadata());
    if (desc.size != decoder.desc().size && !asked.quilt)
        layout.quilt.reset(); // the quilt of the file is that of all its views
    TESSERA_TRY_ASSIGN(
        auto sink, create_texture(a.output, desc, file.description(), a.texture.threads, layout));
    PartSink part(interruptible(std::move(sink)), box.begin);
    Progress progress("tessera decode", a.texture.quiet);
    return with_memory_hint(
        decoder.decode(box, part, a.texture.threads, progress.function(), slab_bytes));
}

Json to_json(const DecodeCommand& a, const Decoder& decoder, const ByteSource& file,
             const Box4& box, double seconds) {
    const TextureDesc& desc = decoder.desc();
    Json json = {{"input", a.input},
                 {"output", a.output},
                 {"box", to_string(box)},
                 {"size", to_string(box.extent())},
                 {"type", name_of(desc.type)},
                 {"channels", desc.channels},
                 {"raw_bytes", desc.box_bytes(box)},
                 {"seconds", seconds},
                 {"filled", fill_json(decoder)}};
    if (const auto traffic = network_traffic(file))
        json["network"] = {{"requests", traffic->requests}, {"bytes", traffic->bytes}};
    return json;
}

void print_summary(const DecodeCommand& a, const Decoder& decoder, const ByteSource& file,
                   const Box4& box, double seconds) {
    std::FILE* to = summary_stream(a.output);
    const TextureDesc& desc = decoder.desc();
    const std::uint64_t bytes = desc.box_bytes(box);
    std::fprintf(to, "%s: %s, %d x %s, %s in %.2f s, %.1f MB/s%s\n", a.output.c_str(),
                 to_string(box.extent()).c_str(), desc.channels, name_of(desc.type),
                 human_bytes(bytes).c_str(), seconds,
                 static_cast<double>(bytes) / 1e6 / std::max(seconds, 1e-9),
                 transfer_text(file).c_str());
    std::fputs(fill_text(decoder, "  ").c_str(), to);
}

Status run(const DecodeCommand& a) {
    TESSERA_TRY(check_json_output(a.json, a.output));
    TESSERA_TRY_ASSIGN(const auto slab_bytes, slab_budget(a.memory, a.texture.threads));
    const DecodeOptions opening = within_budget(a.texture.decode, slab_bytes);
    const auto start = std::chrono::steady_clock::now();
    TESSERA_TRY_ASSIGN(const auto file, open_tess_bytes(a.input, "decode"));
    const auto first = Decoder::open(*file, opening);
    if (!first.ok())
        return with_partial_hint(with_memory_hint(first.status()), *file, opening);
    std::unique_ptr<ByteSource> layer;
    std::optional<Decoder> of_layer;
    if (!a.layer.empty()) {
        TESSERA_TRY_ASSIGN(layer,
                           find_layer(*file, first->container(), a.layer).with_context("--layer"));
    }
    if (layer) {
        TESSERA_TRY_ASSIGN(Decoder opened, Decoder::open(*layer, opening));
        of_layer.emplace(std::move(opened));
    }
    const Decoder& decoder = of_layer ? *of_layer : *first;
    Box4 box = Box4::whole(decoder.desc().size);
    if (!a.box.empty()) {
        TESSERA_TRY_ASSIGN(box, parse_box(a.box, box.extent()).with_context("--box"));
    }
    TESSERA_TRY(decode_into(a, decoder, box));
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    if (a.json)
        print_json(to_json(a, decoder, *file, box, seconds.count()));
    else if (!a.texture.quiet)
        print_summary(a, decoder, *file, box, seconds.count());
    return {};
}

} // namespace

void add_decode_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, DecodeCommand& a) {
        c.add_option("input", a.input, "A .tess, its URL (http, https), or - for standard input")
            ->required();
        c.add_option("-o,--output", a.output,
                     "What to write: .exr, raw samples (.rgb ...), folder/ of views, .png or .jpg "
                     "(a mosaic or a quilt); - is raw samples on standard output")
            ->required();
        c.add_option("--layer", a.layer,
                     "The layer to decode, of a file that has several: diffuse, specular, normal "
                     "...; info lists them. Default: the first one, diffuse")
            ->option_text("NAME");
        c.add_option("--box", a.box,
                     "The part to decode, half-open; ':' is a whole axis. Default: everything")
            ->option_text("U0:U1,V0:V1,S0:S1,T0:T1");
        add_fill_options(c, a.texture.decode);
        add_memory_option(c, a.memory);
        c.add_flag("--json", a.json, "Print the result as JSON");
        add_threads_options(c, a.texture);
        add_view_options(c, a.texture);
        add_network_options(c);
    };
    add_verb<DecodeCommand>(
        app, chosen, "decode", "Write the texels of a .tess file, whole or in part",
        "Only the tiles that the box touches are read. Views keep the names and the format, and "
        "quilts the columns, that they were encoded from.\n\n"
        "Examples:\n"
        "  tessera decode scene.tess -o scene.exr\n"
        "  tessera decode helmet.tess --layer normal -o normals.png\n"
        "  tessera decode scene.tess -o - | sha256sum\n"
        "  tessera decode scene.tess -o views/ --views-pattern 'cam_{t:2}_{s:2}.jpg'\n"
        "  tessera decode beginning.tess --allow-partial -o scene.rgb\n"
        "  tessera decode https://example.org/scene.tess -o part.exr --box 0:64,0:64,:,:",
        declare, run);
}

} // namespace tessera
