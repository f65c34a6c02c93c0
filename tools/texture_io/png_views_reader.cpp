#include "format/work.h"
#include "tools/picture/png_file.h"
#include "tools/support/description_text.h"
#include "tools/support/parse.h"
#include "tools/support/slab_buffer.h"
#include "tools/texture_io/png_views_io.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t max_json_bytes = 1 << 20;

using ViewNames = std::map<std::pair<std::uint32_t, std::uint32_t>, std::string>; // (t, s)

Result<ViewNames> list_views(const std::string& folder) {
    ViewNames names;
    std::error_code error;
    for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        const std::string name = i->path().filename().string();
        std::uint32_t s = 0, t = 0;
        if (!parse_view_file_name(name, s, t))
            continue;
        if (const auto [at, fresh] = names.emplace(std::pair(t, s), name); !fresh)
            return Status(ErrorCode::invalid_file,
                          folder + ": two files for one view: " + at->second + " and " + name);
    }
    if (error)
        return Status(ErrorCode::io, folder + ": " + error.message());
    if (names.empty())
        return Status(ErrorCode::invalid_file,
                      folder + ": holds no views (files named view_tTTT_sSSS.png)");
    return names;
}

// Size (if there is a file) and description. The type can only be unorm8.
Status read_json(const std::string& path, std::optional<Extent4>& size, Description& description) {
    std::error_code error;
    if (!fs::exists(path, error))
        return {};
    const std::uintmax_t bytes = fs::file_size(path, error);
    if (error)
        return {ErrorCode::io, path + ": " + error.message()};
    if (bytes > max_json_bytes)
        return {ErrorCode::invalid_file, path + ": too long"};
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (!file)
        return {ErrorCode::io, path + ": cannot be read"};
    const auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("size") || !json["size"].is_string())
        return {ErrorCode::invalid_file, path + ": is not JSON with a \"size\": \"UxVxSxT\""};
    const auto parsed = parse_extent(json["size"].get<std::string>());
    if (!parsed.ok())
        return {ErrorCode::invalid_file, path + ": " + parsed.status().message()};
    size = *parsed;
    if (!json.contains("description") || !json["description"].is_object())
        return {};
    for (const auto& [field, value] : json["description"].items())
        if (Status s = value.is_string()
                           ? set_description_field(description, field, value.get<std::string>())
                           : Status(ErrorCode::invalid_file, field + " is not text");
            !s.ok())
            return {ErrorCode::invalid_file, path + ": " + s.message()};
    return {};
}

class PngViewsSource : public TexelSource {
public:
    PngViewsSource(std::string folder, unsigned threads)
        : folder_(std::move(folder)), threads_(threads) {}

    Status open(const TextureHints& hints, Description& description) {
        TESSERA_TRY_ASSIGN(names_, list_views(folder_));
        std::optional<Extent4> size = hints.size, written;
        TESSERA_TRY(read_json(folder_ + "/tessera.json", written, description));
        if (!size)
            size = written;
        TESSERA_TRY_ASSIGN(shape_, read_png_shape(view_path(names_.begin()->second)));
        desc_.channels = shape_.channels;
        if (hints.type.value_or(SampleType::unorm8) != SampleType::unorm8)
            return {ErrorCode::bad_argument, folder_ + ": PNG views are 8-bit"};
        desc_.size = size ? *size : infer_size();
        TESSERA_TRY(check_desc(desc_).with_context(folder_));
        TESSERA_TRY(check_names());
        return parallel_for(views(), threads_, [this](std::uint64_t i) { return check_view(i); });
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
    std::string view_path(const std::string& name) const { return folder_ + "/" + name; }
    std::uint64_t views() const { return std::uint64_t{desc_.size[axis_s]} * desc_.size[axis_t]; }

    Extent4 infer_size() const {
        std::uint32_t s = 0, t = 0;
        for (const auto& [place, name] : names_) {
            t = std::max(t, place.first + 1);
            s = std::max(s, place.second + 1);
        }
        return {shape_.width, shape_.height, s, t};
    }

    // Every view of the texture has a file. Names beyond the size are an error too: the size would
    // be wrong.
    Status check_names() const {
        std::uint64_t index = 0;
        for (const auto& [place, name] : names_) {
            const auto [t, s] = place;
            if (s >= desc_.size[axis_s] || t >= desc_.size[axis_t])
                return {ErrorCode::invalid_file,
                        view_path(name) + ": outside the texture of " + to_string(desc_.size)};
            if (std::uint64_t{t} * desc_.size[axis_s] + s != index)
                break;
            ++index;
        }
        if (index < views())
            return {
                ErrorCode::invalid_file,
                view_path(view_file_name(static_cast<std::uint32_t>(index % desc_.size[axis_s]),
                                         static_cast<std::uint32_t>(index / desc_.size[axis_s]))) +
                    ": this view is missing from a texture of " + to_string(desc_.size)};
        return {};
    }

    const std::string& name_at(std::uint32_t s, std::uint32_t t) const {
        return names_.find({t, s})->second; // check_names found them all
    }

    Status check_view(std::uint64_t index) const {
        const auto s = static_cast<std::uint32_t>(index % desc_.size[axis_s]);
        const std::string path =
            view_path(name_at(s, static_cast<std::uint32_t>(index / desc_.size[axis_s])));
        TESSERA_TRY_ASSIGN(const auto shape, read_png_shape(path));
        const PngShape expected{desc_.size[axis_u], desc_.size[axis_v], desc_.channels};
        if (shape == expected)
            return {};
        const auto words = [](const PngShape& p) {
            return std::to_string(p.width) + "x" + std::to_string(p.height) + " pixels of " +
                   std::to_string(p.channels) + " channels";
        };
        return {ErrorCode::invalid_file,
                path + ": has " + words(shape) + " instead of " + words(expected)};
    }

    Status load_view(std::uint32_t s, std::uint32_t t) {
        const Box4 box = slab_.box();
        const std::size_t texel = desc_.texel_bytes();
        const PngShape shape{desc_.size[axis_u], desc_.size[axis_v], desc_.channels};
        const auto store = [&](std::uint32_t v, std::span<const std::byte> row) {
            if (v < box.begin[axis_v])
                return;
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                std::memcpy(slab_.texel(u, v, s, t), row.data() + u * texel, texel);
        };
        return read_png(view_path(name_at(s, t)), shape, box.end[axis_v], store);
    }

    std::string folder_;
    unsigned threads_;
    ViewNames names_;
    PngShape shape_;
    TextureDesc desc_;
    SlabBuffer slab_;
};

} // namespace

std::string view_file_name(std::uint32_t s, std::uint32_t t) {
    const auto digits = [](std::uint32_t n) {
        const std::string text = std::to_string(n);
        return std::string(text.size() < 3 ? 3 - text.size() : 0, '0') + text;
    };
    return "view_t" + digits(t) + "_s" + digits(s) + ".png";
}

bool parse_view_file_name(const std::string& name, std::uint32_t& s, std::uint32_t& t) {
    const std::size_t middle = name.find("_s", 6);
    if (name.rfind("view_t", 0) != 0 || middle == std::string::npos || name.size() < middle + 7 ||
        name.compare(name.size() - 4, 4, ".png") != 0)
        return false;
    const std::string first = name.substr(6, middle - 6);
    const std::string second = name.substr(middle + 2, name.size() - 4 - (middle + 2));
    std::uint64_t a = 0, b = 0;
    if (first.size() > 7 || second.size() > 7 || !parse_number(first, a) ||
        !parse_number(second, b))
        return false;
    t = static_cast<std::uint32_t>(a);
    s = static_cast<std::uint32_t>(b);
    return true;
}

Result<std::unique_ptr<TexelSource>>
open_png_views(const std::string& folder, const TextureHints& hints, Description& description) {
    auto source = std::make_unique<PngViewsSource>(folder, hints.threads);
    TESSERA_TRY(source->open(hints, description));
    return std::unique_ptr<TexelSource>(std::move(source));
}

} // namespace tessera
