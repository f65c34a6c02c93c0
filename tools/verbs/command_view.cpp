#include "format/output_file.h"
#include "format/sampler.h"
#include "tools/http/open_bytes.h"
#include "tools/page/page.h"
#include "tools/page/view_data.h"
#include "tools/picture/picture_encoders.h"
#include "tools/support/interrupt.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/system.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"
#include "tools/view/outside_colour.h"
#include "tools/view/render_stage.h"
#include "tools/view/view_file.h"
#ifdef TESSERA_HTTP
#include "tools/page/viewer_server.h"
#include "tools/server/file_server_paths.h"
#endif

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace tessera {
namespace {

struct ViewCommand {
    std::string file, output;
    int port = 0;
    bool no_open = false, quiet = false;
};

// Browsers do not open pages with more base64 than this.
constexpr std::uint64_t most_file_bytes = 256ull << 20;

Status too_large(const std::string& name, std::uint64_t bytes) {
    return {ErrorCode::unsupported,
            name + ": " + human_bytes(bytes) +
                " are too many for one page; without -o the page reads the file in parts"};
}

// Pixels of the picture that the page contains and shows until the viewer has started.
constexpr std::uint32_t poster_width = 128, poster_height = 96;

Result<std::vector<std::byte>> to_png(const Picture& picture) {
    return encode_png({picture.width, picture.height, 3}, picture.rgb);
}

// The middle one of planar views, every n-th texel.
Result<Picture> middle_view(const Decoder& decoder) {
    const Extent4& size = decoder.desc().size;
    const std::uint32_t s = size[axis_s] / 2, t = size[axis_t] / 2;
    const std::uint32_t step =
        std::max({size[axis_u] / poster_width, size[axis_v] / poster_height, 1u});
    const Box4 box{{0, 0, s, t}, {size[axis_u], size[axis_v], s + 1, t + 1}};
    std::vector<std::byte> texels(decoder.desc().box_bytes(box));
    TESSERA_TRY(decoder.decode_box(box, texels));
    View view{std::max(size[axis_u] / step, 1u), std::max(size[axis_v] / step, 1u), {}};
    for (std::uint32_t v = 0; v < view.height; ++v)
        for (std::uint32_t u = 0; u < view.width; ++u) {
            const std::size_t texel = std::size_t{v} * step * size[axis_u] + std::size_t{u} * step;
            const glm::dvec4 value =
                texel_value(decoder.desc(), texels.data() + texel * decoder.desc().texel_bytes());
            for (glm::length_t c = 0; c < 3; ++c)
                view.rgb.push_back(
                    static_cast<float>(decoder.desc().channels >= 3 ? value[c] : value.x));
        }
    return to_picture(view, decoder.desc().type);
}

// The viewer's first view. Empty if the surface cannot be drawn here, or if the file is standard
// input.
Result<std::vector<std::byte>> draw_poster(const ViewCommand& a, const Decoder& decoder) {
    const Description& about = decoder.container().description();
    if (about.proxy == Proxy::none && about.angular_map == AngularMap::planar_views) {
        TESSERA_TRY_ASSIGN(const Picture picture, middle_view(decoder));
        return to_png(picture);
    }
    if (a.file == "-")
        return std::vector<std::byte>{};
    StageRequest request;
    request.file = a.file;
    RenderOptions options;
    TESSERA_TRY_ASSIGN(const Stage stage, set_up_stage(request, options));
    CameraPose pose;
    if (stage.window && stage.window->inside)
        pose = {stage.window->centre, stage.window->centre + glm::dvec3(-1, 0, 0)};
    TESSERA_TRY_ASSIGN(const Camera camera, make_camera(pose, {45, poster_width, poster_height}));
    if (stage.window && !check_side(*stage.window, camera).ok())
        return std::vector<std::byte>{};
    TESSERA_TRY_ASSIGN(const View view, stage.subject().render(camera));
    return to_png(to_picture(view, stage.desc.type));
}

// A file on a server is fetched whole, because the page and the colours and mesh for it read it
// twice.
Result<std::unique_ptr<ByteSource>> open_for_page(const std::string& name,
                                                  std::vector<std::byte>& fetched) {
    TESSERA_TRY_ASSIGN(std::unique_ptr<ByteSource> source, open_tess_bytes(name, "view"));
    if (source->size() > most_file_bytes)
        return too_large(source->name(), source->size());
    if (!is_url(name))
        return source;
    fetched.resize(static_cast<std::size_t>(source->size()));
    TESSERA_TRY(source->read(0, fetched));
    return wrap_memory(fetched);
}

Status write_page(const ViewCommand& a) {
    TESSERA_TRY(check_output_path(a.output));
    std::vector<std::byte> fetched;
    TESSERA_TRY_ASSIGN(const auto source, open_for_page(a.file, fetched));
    TESSERA_TRY_ASSIGN(const Decoder decoder, Decoder::open(*source));
    PageContents page;
    page.title = to_path(a.file).filename().string();
    TESSERA_TRY_ASSIGN(const glm::dvec3 outside, outside_colour(decoder.container()));
    page.background = outside;
    page.file = source.get();
    TESSERA_TRY_ASSIGN(page.view_data, make_view_data(*source, decoder.container()));
    TESSERA_TRY_ASSIGN(page.poster, draw_poster(a, decoder));
    TESSERA_TRY_ASSIGN(OutputFile html, OutputFile::create(a.output));
    TESSERA_TRY(write_page(page, [&html](std::string_view piece) -> Status {
        TESSERA_TRY(check_interrupt());
        return html.append(std::as_bytes(std::span(piece)));
    }));
    const std::uint64_t bytes = html.appended();
    TESSERA_TRY(html.commit());
    if (!a.quiet)
        std::printf("%s: %s, of which the texture %s\n", a.output.c_str(),
                    human_bytes(bytes).c_str(), human_bytes(source->size()).c_str());
    return {};
}

#ifdef TESSERA_HTTP

Status serve_page(const ViewCommand& a) {
    if (is_url(a.file))
        return {ErrorCode::bad_argument, a.file + ": view serves local files only; -o page.html "
                                                  "accepts URLs"};
    TESSERA_TRY(make_server_page().status()); // fails here if the build lacks the decoder
    TESSERA_TRY_ASSIGN(const auto file, open_tess_bytes(a.file, "view"));
    TESSERA_TRY(Decoder::open(*file).status());
    // Serves only this file, also if the name is a link to it: any page in the browser can send
    // requests to this server.
    const GlbName glb = split_glb_name(a.file);
    std::error_code error;
    const std::filesystem::path path = std::filesystem::canonical(to_path(glb.file), error);
    if (error)
        return {ErrorCode::io, a.file + ": " + error.message()};
    FileServerOptions options = folder_with_viewer(path.parent_path().string());
    options.only = path.filename().string();
    options.port = a.port;
    TESSERA_TRY_ASSIGN(const auto server, FileServer::start(options));
    const std::string url = server->url() + "?f=" + percent_encoded(path.filename().string()) +
                            (glb.texture ? "&texture=" + std::to_string(*glb.texture) : "");
    std::printf("%s\n", url.c_str());
    std::fflush(stdout);
    if (!a.no_open)
        open_in_browser(url); // failures do not matter, since the URL is on the screen
    serve_until_interrupted();
}

#else

Status serve_page(const ViewCommand&) {
    return {ErrorCode::unsupported,
            "this program was built without HTTP; -o page.html writes a page"};
}

#endif

Status run(const ViewCommand& a) {
    return a.output.empty() ? serve_page(a) : write_page(a);
}

} // namespace

void add_view_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, ViewCommand& a) {
        c.add_option("file", a.file,
                     "A .tess with a texture on a sphere, on a mesh, or of planar views; or a .glb "
                     "that holds one")
            ->required();
        auto* output = c.add_option("-o,--output", a.output,
                                    "Write one HTML file with viewer, decoder and texture, which "
                                    "needs no server and no network");
        c.add_option("--port", a.port, "Port of the served page; 0 picks a free one. Default: 0")
            ->check(CLI::Range(0, 65535))
            ->excludes(output)
            ->option_text("N");
        c.add_flag("--no-open", a.no_open, "Print the URL of the page, but do not open a browser")
            ->excludes(output)
            ->option_text(" ");
        c.add_flag("--quiet,-q", a.quiet, "Print no summary");
    };
    add_verb<ViewCommand>(
        app, chosen, "view", "Show a texture in a browser",
        "Without -o, this machine serves a page at 127.0.0.1 until Ctrl-C, and opens it in the "
        "browser. "
        "The page reads the file in parts, so large files, and those encoded with --layers, are "
        "visible at once. Its button ? explains mouse and keys.\n\n"
        "Examples:\n"
        "  tessera view scene.tess\n"
        "  tessera view scene.tess -o scene.html\n"
        "  tessera view http://host/scene.tess -o scene.html",
        declare, run);
}

} // namespace tessera
