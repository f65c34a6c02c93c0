#include "format/output_file.h"
#include "format/work.h"
#include "tools/support/slab_buffer.h"
#include "tools/texture_io/picture_format.h"
#include "tools/texture_io/view_names.h"
#include "tools/texture_io/views_io.h"
#include "tools/texture_io/views_json.h"

#include <filesystem>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// Whether replacing `folder` loses nothing: it does not exist, is empty, or was written by us.
Status check_replaceable(const std::string& folder) {
    std::error_code error;
    const fs::file_status status = fs::status(to_path(folder), error);
    if (!fs::exists(status))
        return {};
    if (!fs::is_directory(status))
        return {ErrorCode::io, folder + ": exists and is not a folder"};
    const bool ours = fs::exists(to_path(folder + "/" + views_json_name), error);
    const auto json = read_views_json(folder);
    const std::string kept = json.ok() && *json ? (*json)->layout.pattern : "";
    TESSERA_TRY_ASSIGN(const auto pattern,
                       ViewPattern::parse(kept.empty() ? usual_view_pattern : kept));
    std::string other;
    const std::vector<std::string> names = names_in(folder, error);
    for (const std::string& name : names)
        if (name != views_json_name && !pattern.match(name))
            other = name;
    if (error)
        return {ErrorCode::io, folder + ": " + error.message()};
    if (!other.empty())
        return {ErrorCode::io, folder + ": holds a file that is no view (" + other +
                                   "); choose an empty or a new folder"};
    if (!ours && !names.empty())
        return {ErrorCode::io, folder +
                                   ": holds views but no tessera.json, so this program did not "
                                   "write them; choose an empty or a new folder"};
    return {};
}

class ViewsSink : public TexelSink {
public:
    ViewsSink(std::string folder, const TextureDesc& desc, const Description& description,
              const ViewLayout& layout, ViewPattern pattern, unsigned threads)
        : folder_(std::move(folder)), desc_(desc), description_(description), layout_(layout),
          pattern_(std::move(pattern)), threads_(threads) {}

    Status open() {
        TESSERA_TRY(check_replaceable(folder_));
        TESSERA_TRY_ASSIGN(output_, OutputFolder::create(folder_));
        return {};
    }

    Locality locality() const override { return Locality::angular_cells; }

    Status begin_slab(const Box4& box) override {
        if (!spans(box, desc_.size, axis_u, axis_v))
            return {ErrorCode::runtime,
                    folder_ + ": slab " + to_string(box) + " does not hold whole views"};
        return slab_.reset(desc_, box).with_context(folder_);
    }

    Status write(const Box4& box, std::span<const std::byte> texels) override {
        return slab_.copy_in(box, texels).with_context(folder_);
    }

    Status end_slab() override {
        const Box4& box = slab_.box();
        const Extent4 e = box.extent();
        const std::uint64_t count = std::uint64_t{e[axis_s]} * e[axis_t];
        TESSERA_TRY(parallel_for(count, threads_, [&](std::uint64_t i) {
            return write_view(box.begin[axis_s] + static_cast<std::uint32_t>(i % e[axis_s]),
                              box.begin[axis_t] + static_cast<std::uint32_t>(i / e[axis_s]));
        }));
        written_ += count;
        return {};
    }

    Status finish() override {
        slab_.clear();
        if (written_ != std::uint64_t{desc_.size[axis_s]} * desc_.size[axis_t])
            return {ErrorCode::runtime, folder_ + ": views are missing"};
        TESSERA_TRY(write_json());
        TESSERA_TRY(check_replaceable(folder_)); // it may have changed meanwhile
        return output_.commit();
    }

private:
    Status write_view(std::uint32_t s, std::uint32_t t) {
        const Extent4& size = desc_.size;
        const Box4 view{{0, 0, s, t}, {size[axis_u], size[axis_v], s + 1, t + 1}};
        std::vector<std::byte> pixels(desc_.box_bytes(view));
        TESSERA_TRY(slab_.copy_out(view, pixels));
        TESSERA_TRY_ASSIGN(const auto file,
                           encode_picture(picture_kind_of_name(pattern_.text()),
                                          {size[axis_u], size[axis_v], desc_.channels}, desc_.type,
                                          pixels)
                               .with_context(folder_));
        const ViewGrid grid{size[axis_s], size[axis_t]};
        return output_.add(view_name(pattern_, layout_.order, grid, {s, t}), file);
    }

    Status write_json() const {
        const std::string text = to_text(desc_, description_, layout_);
        return output_.add(views_json_name, std::as_bytes(std::span(text)));
    }

    std::string folder_;
    OutputFolder output_;
    TextureDesc desc_;
    Description description_;
    ViewLayout layout_;
    ViewPattern pattern_;
    unsigned threads_;
    std::uint64_t written_ = 0;
    SlabBuffer slab_;
};

Result<ViewPattern> pattern_for(const ViewLayout& layout) {
    return ViewPattern::parse(layout.pattern.empty() ? usual_view_pattern : layout.pattern);
}

} // namespace

Status check_views_output(const TextureDesc& desc, const ViewLayout& layout) {
    TESSERA_TRY_ASSIGN(const auto pattern, pattern_for(layout));
    const auto is_ambiguous = [&](Axis axis, const char* letter) {
        return !pattern.is_running() && desc.size[axis] > 1 &&
               pattern.text().find(std::string("{") + letter) == std::string::npos;
    };
    if (is_ambiguous(axis_s, "s") || is_ambiguous(axis_t, "t"))
        return {ErrorCode::bad_argument, "the pattern '" + pattern.text() +
                                             "' gives several views of " + to_string(desc.size) +
                                             " the same name; it needs {t} and {s}, or {n}"};
    return check_picture_kind(picture_kind_of_name(pattern.text()), desc.type, desc.channels);
}

Result<std::unique_ptr<TexelSink>> create_views(const std::string& folder, const TextureDesc& desc,
                                                const Description& description,
                                                const ViewLayout& layout, unsigned threads) {
    TESSERA_TRY(check_desc(desc).with_context(folder));
    TESSERA_TRY(check_views_output(desc, layout).with_context(folder));
    TESSERA_TRY_ASSIGN(auto pattern, pattern_for(layout));
    auto sink =
        std::make_unique<ViewsSink>(folder, desc, description, layout, std::move(pattern), threads);
    TESSERA_TRY(sink->open());
    return std::unique_ptr<TexelSink>(std::move(sink));
}

} // namespace tessera
