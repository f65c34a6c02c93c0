#include "corpus/picture_file.h"
#include "format/output_file.h"
#include "format/work.h"
#include "tools/support/interrupt.h"
#include "tools/support/slab_buffer.h"
#include "tools/texture_io/clamped_rows.h"
#include "tools/texture_io/picture_format.h"
#include "tools/texture_io/view_motion.h"
#include "tools/texture_io/view_names.h"
#include "tools/texture_io/views_io.h"
#include "tools/texture_io/views_json.h"

#include <cstring>

namespace tessera {
namespace {

using corpus::PictureShape;

// The names of pictures, by their endings, without hidden files. Sorted, so that messages are the
// same everywhere.
Result<std::vector<std::string>> list_pictures(const std::string& folder) {
    std::vector<std::string> names;
    std::error_code error;
    for (std::string& name : names_in(folder, error))
        if (!name.starts_with('.') && picture_kind_of_name(name) != corpus::PictureKind::none)
            names.push_back(std::move(name));
    if (error)
        return Status(ErrorCode::io, folder + ": " + error.message());
    if (names.empty())
        return Status(ErrorCode::invalid_file,
                      folder + ": holds no views (" + picture_endings + ")");
    std::sort(names.begin(), names.end());
    return names;
}

constexpr std::uint32_t most_crop_side = 256; // pixels, of the parts that are compared

class ViewsSource : public TexelSource {
public:
    ViewsSource(std::string folder, unsigned threads)
        : folder_(std::move(folder)), threads_(threads) {}

    Status open(const TextureHints& hints, ViewsFacts& facts) {
        options_ = {.exif = hints.views.exif, .layer = hints.views.layer};
        warnings_ = hints.warnings;
        TESSERA_TRY_ASSIGN(const auto names, list_pictures(folder_));
        TESSERA_TRY_ASSIGN(const auto json, read_views_json(folder_));
        ViewHints views = hints.views;
        std::optional<Extent4> size = hints.size;
        if (json) {
            facts.described = true;
            facts.description = json->description;
            facts.layout.cameras = json->layout.cameras;
            if (views.pattern.empty())
                views.pattern = json->layout.pattern;
            if (!views.order)
                views.order = json->layout.order;
            if (!size)
                size = json->size;
        }
        TESSERA_TRY(arrange(names, views, size).with_context(folder_));
        TESSERA_TRY(check_views(hints, size));
        if (views_.axes_are_guessed && desc_.size[axis_s] > 1 && desc_.size[axis_t] > 1) {
            TESSERA_TRY_ASSIGN(const bool swapped, axes_look_swapped());
            if (swapped) {
                views.order = ViewOrder{.columns = true};
                TESSERA_TRY(arrange(names, views, size).with_context(folder_));
                TESSERA_TRY(check_views(hints, size));
                by_motion_ = ", as the views move";
            }
        }
        facts.layout.pattern = writable_picture_name(views_.pattern.text(), desc_.type);
        facts.layout.order = views_.order;
        facts.told = summary(names.size());
        return {};
    }

    const TextureDesc& desc() const override { return desc_; }
    Locality locality() const override { return Locality::angular_cells; }

    Status begin_slab(const Box4& box) override {
        TESSERA_TRY(slab_.reset(desc_, box).with_context(folder_));
        const Extent4 e = box.extent();
        const std::uint64_t count = std::uint64_t{e[axis_s]} * e[axis_t];
        return parallel_for(count, threads_, [&](std::uint64_t i) {
            return load_view(box.begin[axis_s] + static_cast<std::uint32_t>(i % e[axis_s]),
                             box.begin[axis_t] + static_cast<std::uint32_t>(i / e[axis_s]));
        });
    }

    Status read(const Box4& box, std::span<std::byte> out) override {
        return slab_.copy_out(box, out).with_context(folder_);
    }

private:
    std::string path_of(std::size_t view) const { return folder_ + "/" + views_.names[view]; }

    // Decides which pictures are views, and where.
    Status arrange(const std::vector<std::string>& names, const ViewHints& views,
                   const std::optional<Extent4>& size) {
        std::optional<ViewGrid> grid;
        if (size) {
            TESSERA_TRY(check_desc({.size = *size, .channels = 1}));
            grid = ViewGrid{(*size)[axis_s], (*size)[axis_t]};
        }
        if (grid && views.grid && *grid != *views.grid)
            return {ErrorCode::bad_argument, "is " + to_string(*size) + ", not of a grid of " +
                                                 to_string(*views.grid) + " cameras"};
        TESSERA_TRY_ASSIGN(views_, arrange_views(names, views, grid));
        return {};
    }

    // `say`: whether what the picture states in vain becomes a warning.
    Result<PictureShape> shape_of(std::size_t view, bool say) const {
        TESSERA_TRY_ASSIGN(const auto file, open_file(path_of(view)));
        TESSERA_TRY_ASSIGN(const auto reader, corpus::open_picture_file(*file, options_));
        if (say && warnings_ != nullptr)
            for (const std::string& note : reader->notes())
                TESSERA_TRY(warnings_->add(note, path_of(view)));
        return reader->shape();
    }

    // Reads the headers of all views, which must agree with the first one and with `size`.
    Status check_views(const TextureHints& hints, const std::optional<Extent4>& size) {
        TESSERA_TRY_ASSIGN(const PictureShape first, shape_of(0, false));
        desc_.channels = first.channels;
        desc_.type = hints.type.value_or(first.usual_type());
        desc_.size =
            size.value_or(Extent4{first.width, first.height, views_.grid.s, views_.grid.t});
        TESSERA_TRY(check_desc(desc_).with_context(folder_));
        shapes_.resize(views_.names.size());
        counted_.resize(views_.names.size());
        return parallel_for(views_.names.size(), threads_,
                            [this](std::uint64_t i) { return check_view(i); });
    }

    Status check_view(std::size_t view) {
        TESSERA_TRY(check_interrupt());
        TESSERA_TRY_ASSIGN(shapes_[view], shape_of(view, true));
        const auto words = [](std::uint32_t width, std::uint32_t height, unsigned channels) {
            return std::to_string(width) + "x" + std::to_string(height) + " pixels of " +
                   std::to_string(channels) + " channels";
        };
        const PictureShape& shape = shapes_[view];
        if (shape.width == desc_.size[axis_u] && shape.height == desc_.size[axis_v] &&
            shape.channels == desc_.channels)
            return {};
        return {ErrorCode::invalid_file,
                path_of(view) + ": has " + words(shape.width, shape.height, shape.channels) +
                    " instead of " + words(desc_.size[axis_u], desc_.size[axis_v], desc_.channels)};
    }

    // The middle of a view.
    Result<ViewCrop> crop_of(std::uint32_t s, std::uint32_t t) const {
        const std::size_t view = std::size_t{t} * desc_.size[axis_s] + s;
        TESSERA_TRY_ASSIGN(const auto file, open_file(path_of(view)));
        TESSERA_TRY_ASSIGN(const auto reader, corpus::open_picture_file(*file, options_));
        const corpus::PictureShape& shape = reader->shape();
        ViewCrop crop{
            std::min(shape.width, most_crop_side), std::min(shape.height, most_crop_side), {}};
        const std::uint32_t left = (shape.width - crop.width) / 2;
        const std::uint32_t top = (shape.height - crop.height) / 2;
        const std::size_t green = shape.channels < 3 ? 0 : 1; // most of brightness
        TESSERA_TRY(reader->read_rows(SampleType::unorm8, top, top + crop.height,
                                      [&](std::uint32_t, std::span<const std::byte> row) {
                                          for (std::uint32_t x = 0; x < crop.width; ++x)
                                              crop.grey.push_back(std::to_integer<std::uint8_t>(
                                                  row[(left + x) * shape.channels + green]));
                                      }));
        return crop;
    }

    // Whether content moves down where s grows and sideways where t grows, in the middle of the
    // grid.
    Result<bool> axes_look_swapped() const {
        const std::uint32_t s = (desc_.size[axis_s] - 1) / 2, t = (desc_.size[axis_t] - 1) / 2;
        TESSERA_TRY_ASSIGN(const ViewCrop here, crop_of(s, t));
        TESSERA_TRY_ASSIGN(const ViewCrop right, crop_of(s + 1, t));
        if (motion_between(here, right) != Motion::vertical)
            return false;
        TESSERA_TRY_ASSIGN(const ViewCrop below, crop_of(s, t + 1));
        return motion_between(here, below) == Motion::horizontal;
    }

    // For people. `pictures`: how many the folder has.
    std::string summary(std::size_t pictures) const {
        const std::string order = to_string(views_.order);
        const std::size_t others = pictures - views_.names.size();
        const bool rounded = sample_bytes(desc_.type) == 1 &&
                             std::ranges::any_of(shapes_, [](auto& s) { return s.bits == 16; });
        return std::to_string(views_.names.size()) + " views named " + views_.pattern.text() +
               (others > 0 ? " (other pictures left out: " + std::to_string(others) + ")" : "") +
               ", " + to_string(views_.grid) + " cameras from the " +
               (views_.order.bottom_up ? "bottom " : "top ") +
               (views_.order.right_left ? "right" : "left") +
               (order.empty() ? "" : " (" + order + by_motion_ + ")") +
               (rounded ? "; 16-bit samples are rounded to 8 (--type half keeps 11)" : "");
    }

    Status load_view(std::uint32_t s, std::uint32_t t) {
        TESSERA_TRY(check_interrupt());
        const Box4 box = slab_.box();
        const std::size_t view = std::size_t{t} * desc_.size[axis_s] + s;
        const std::size_t texel = desc_.texel_bytes();
        TESSERA_TRY_ASSIGN(const auto file, open_file(path_of(view)));
        TESSERA_TRY_ASSIGN(const auto reader, corpus::open_picture_file(*file, options_));
        if (reader->shape() != shapes_[view])
            return {ErrorCode::invalid_file, path_of(view) + ": changed while it was read"};
        ClampedRows clamped(counted_[view]);
        TESSERA_TRY(reader->read_rows(
            desc_.type, box.begin[axis_v], box.end[axis_v],
            [&](std::uint32_t v, std::span<const std::byte> row) {
                clamped.add(v, reader->clamped_in_row());
                for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                    std::memcpy(slab_.texel(u, v, s, t), row.data() + u * texel, texel);
            }));
        return clamped.say(warnings_, path_of(view));
    }

    std::string folder_;
    unsigned threads_;
    corpus::PictureOptions options_;
    Warnings* warnings_ = nullptr;
    std::vector<std::vector<bool>> counted_; // by view, for ClampedRows
    NamedViews views_;
    std::string by_motion_;            // for people: why the order is another one
    std::vector<PictureShape> shapes_; // in the order of views_.names
    TextureDesc desc_;
    SlabBuffer slab_;
};

} // namespace

Result<std::unique_ptr<TexelSource>> open_views(const std::string& folder,
                                                const TextureHints& hints, ViewsFacts& facts) {
    auto source = std::make_unique<ViewsSource>(folder, hints.threads);
    TESSERA_TRY(source->open(hints, facts));
    return std::unique_ptr<TexelSource>(std::move(source));
}

} // namespace tessera
