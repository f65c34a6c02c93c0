#include "corpus/picture/exr_layers.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfPartType.h>
#include <algorithm>
#include <cctype>

namespace tessera::corpus {
namespace {

constexpr std::size_t most_layers_named = 20;  // in a message
constexpr std::size_t longest_layer_name = 60; // of a layer in a message
constexpr std::size_t most_layer_channels = 4;

// A layer with the ends of its channels' names, "R" of "left.R", in alphabetical order.
struct FoundLayer {
    int part = 0;
    std::string prefix, name;
    std::vector<std::string> ends;
    bool is_deep = false;

    bool has(const std::string& end) const { return std::ranges::find(ends, end) != ends.end(); }
    // X, Y and Z of a layer are normals or positions, and not colours.
    bool has_colours() const {
        return !is_deep && ((has("R") && has("G") && has("B")) || (has("Y") && !has("X")));
    }
};

std::string layer_name(const std::string& part, const std::string& prefix) {
    if (part.empty() || prefix == part || prefix.starts_with(part + "."))
        return prefix;
    return prefix.empty() ? part : part + "." + prefix;
}

std::vector<FoundLayer> find_layers(const Imf::MultiPartInputFile& file) {
    std::vector<FoundLayer> found;
    for (int part = 0; part < file.parts(); ++part) {
        const Imf::Header& header = file.header(part);
        const bool is_named = file.parts() > 1 && header.hasName();
        const std::size_t first = found.size(); // of this part
        for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
            const std::string channel = i.name();
            const std::size_t dot = channel.rfind('.');
            const bool has_prefix = dot != std::string::npos;
            const std::string prefix = has_prefix ? channel.substr(0, dot + 1) : "";
            auto at = std::find_if(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(),
                                   [&](const FoundLayer& l) { return l.prefix == prefix; });
            if (at == found.end()) {
                FoundLayer layer{.part = part, .prefix = prefix, .name = {}, .ends = {}};
                layer.name = layer_name(is_named ? header.name() : "",
                                        has_prefix ? channel.substr(0, dot) : "");
                layer.is_deep = header.hasType() && !Imf::isImage(header.type());
                at = found.insert(found.end(), std::move(layer));
            }
            at->ends.push_back(has_prefix ? channel.substr(dot + 1) : channel);
        }
    }
    return found;
}

std::string join_ends(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ",") + name.substr(0, longest_layer_name);
    return text.substr(0, 200);
}

std::string list_layers(const std::vector<FoundLayer>& layers) {
    std::string text;
    for (std::size_t i = 0; i < std::min(layers.size(), most_layers_named); ++i)
        text += (i > 0 ? ", " : "") +
                (layers[i].name.empty() ? "(none)" : layers[i].name.substr(0, longest_layer_name)) +
                " (" + join_ends(layers[i].ends) + ")";
    return text + (layers.size() > most_layers_named
                       ? " and " + std::to_string(layers.size() - most_layers_named) + " more"
                       : "");
}

bool same_layer_text(std::string_view a, std::string_view b) {
    const auto lower = [](char c) {
        return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    };
    return std::ranges::equal(a, b, {}, lower, lower);
}

// The whole name or an end of it behind a dot, in either case.
bool layer_fits(const std::string& name, const std::string& wish) {
    if (name.size() < wish.size())
        return false;
    const std::size_t begin = name.size() - wish.size();
    return same_layer_text(std::string_view(name).substr(begin), wish) &&
           (begin == 0 || name[begin - 1] == '.');
}

Result<FoundLayer> find_layer(const std::vector<FoundLayer>& layers, const std::string& wish) {
    std::vector<FoundLayer> fitting;
    for (const FoundLayer& layer : layers) {
        if (layer.name == wish)
            return layer;
        if (!layer.name.empty() && layer_fits(layer.name, wish))
            fitting.push_back(layer);
    }
    if (fitting.size() == 1)
        return fitting.front();
    return Status(ErrorCode::bad_argument,
                  (fitting.empty() ? "has no layer '" : "has several layers '") +
                      wish.substr(0, longest_layer_name) +
                      "'; its layers are: " + list_layers(fitting.empty() ? layers : fitting));
}

Result<FoundLayer> usual_layer(const std::vector<FoundLayer>& layers) {
    const std::string advice = "; say which by --layer: " + list_layers(layers);
    std::vector<const FoundLayer*> coloured;
    for (const FoundLayer& layer : layers) {
        if (layer.name.empty() && (layer.has_colours() || layers.size() == 1 || layer.has("X")))
            return layer;
        if (layer.has_colours())
            coloured.push_back(&layer);
    }
    if (coloured.size() == 1)
        return *coloured.front();
    if (coloured.empty() && layers.size() == 1)
        return layers.front();
    return Status(ErrorCode::bad_argument, coloured.empty()
                                               ? "no layer has channels R,G,B or Y" + advice
                                               : "has several layers with colours" + advice);
}

// Sets `colours` and the ends of the channels, in our order.
Status order_channels(const FoundLayer& found, bool any, const Imf::ChannelList& list,
                      ExrLayer& layer, std::vector<std::string>& ends) {
    const auto end_list = [&](std::vector<std::string> names) {
        if (found.has("A"))
            names.emplace_back("A");
        ends = std::move(names);
    };
    const bool is_rgb = found.has("R") && found.has("G") && found.has("B");
    if (is_rgb) {
        end_list({"R", "G", "B"});
        return {};
    }
    if (found.has("Y") && found.has("RY") && found.has("BY") && !found.has("R")) {
        const Imf::Channel* red = list.findChannel((found.prefix + "RY").c_str());
        const bool is_full = red->xSampling == 1 && red->ySampling == 1;
        layer.colours = is_full ? ExrColours::chroma : ExrColours::reduced_chroma;
        if (is_full)
            end_list({"RY", "Y", "BY"});
        else
            end_list({"R", "G", "B"}); // which OpenEXR makes
        return {};
    }
    if (found.has("X") && found.has("Y") && found.has("Z") && !any) {
        layer.colours = ExrColours::xyz;
        end_list({"X", "Y", "Z"});
        return {};
    }
    if (found.has("Y") && !found.has("R") && !found.has("X")) {
        end_list({"Y"});
        return {};
    }
    if (!any) {
        const char* missing = !found.has("R") ? "R" : !found.has("G") ? "G" : "B";
        return {ErrorCode::invalid_file,
                std::string("channel ") + missing +
                    " is missing; needed are R,G,B[,A] or Y[,A], present are " +
                    join_ends(found.ends)};
    }
    if (found.ends.size() > most_layer_channels)
        return {ErrorCode::unsupported,
                "layer " + found.name.substr(0, longest_layer_name) + " has " +
                    std::to_string(found.ends.size()) +
                    " channels, at most 4 are read: " + join_ends(found.ends)};
    ends = found.ends;
    return {};
}

} // namespace

Result<ExrLayer> choose_layer(const Imf::MultiPartInputFile& file, const std::string& wish) {
    const auto layers = find_layers(file);
    if (layers.empty())
        return Status(ErrorCode::invalid_file, "the picture has no channels");
    TESSERA_TRY_ASSIGN(const FoundLayer found,
                       wish.empty() ? usual_layer(layers) : find_layer(layers, wish));
    ExrLayer layer{.part = found.part, .prefix = found.prefix, .name = found.name, .channels = {}};
    const Imf::ChannelList& list = file.header(found.part).channels();
    std::vector<std::string> ends;
    TESSERA_TRY(order_channels(found, !wish.empty() || !found.name.empty(), list, layer, ends));
    for (const std::string& end : ends) {
        layer.channels.push_back(found.prefix + end);
        const Imf::Channel* channel = list.findChannel(layer.channels.back().c_str());
        if (layer.colours != ExrColours::reduced_chroma &&
            (channel->xSampling != 1 || channel->ySampling != 1))
            return Status(ErrorCode::unsupported, "channel " + end + " is subsampled");
    }
    return layer;
}

} // namespace tessera::corpus
