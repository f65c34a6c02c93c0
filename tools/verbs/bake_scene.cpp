#include "tools/verbs/bake_scene.h"

#include "corpus/catalog.h"
#include "corpus/layers/scene_layers.h"
#include "corpus/surface/scene_surface.h"
#include "tools/scenes/baked_surface.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/verbs/bake_layers.h"
#include "tools/verbs/scene_estimate.h"
#include "tools/verbs/write_layers.h"

namespace tessera {
namespace {

constexpr corpus::Texels2 one_direction{1, 1};

} // namespace

bool is_on_own_surfaces(const BakeCommand& a) {
    const auto proxy = a.encode.description.find("proxy");
    return proxy != a.encode.description.end() && proxy->second == "mesh";
}

Result<BakeChoice> choose_scene_layers(const BakeCommand& a) {
    TESSERA_TRY_ASSIGN(const corpus::Scene made, corpus::make_scene(a.scene));
    const corpus::Scene scene = corpus::with_surfaces(made);
    TESSERA_TRY_ASSIGN(const corpus::SurfaceWish wish, surface_wish(a));
    if (a.layered)
        TESSERA_TRY(check_layered(a));
    std::string why_not;
    if (traits_of(scene.type).is_float)
        why_not = "its light is scene-linear, and layers of a scene hold display values";
    else if (!corpus::any_shines(scene))
        why_not = "nothing shines";
    else if (wish.directions == one_direction)
        why_not = "layers have more than one direction";
    else if (a.single)
        why_not = "--single asks for it";
    else if (const std::string of_one = option_of_one_texture(a); !of_one.empty())
        why_not = of_one + " does not apply to layers";
    if (why_not.empty()) {
        TESSERA_TRY_ASSIGN(const bool fit, corpus::differences_fit(scene, wish));
        if (!fit)
            why_not = "highlights and mirror images would have too many texels; --density makes "
                      "fewer";
    }
    if (a.layered && !why_not.empty())
        return Status(ErrorCode::unsupported, "--layered: " + a.scene + ": " + why_not);
    BakeChoice choice{.layered = why_not.empty(), .why = why_not};
    if (choice.layered)
        choice.why = a.layered ? "--layered asks for them"
                               : "highlights and mirror images need fewer places than colours";
    if (speaks(a))
        TESSERA_TRY(estimate_scene(a, scene, wish, choice));
    return choice;
}

Status bake_layered_scene(const BakeCommand& a) {
    BakedLayers baked;
    TESSERA_TRY_ASSIGN(const corpus::Scene scene, corpus::make_scene(a.scene));
    corpus::SceneLayersOptions options;
    TESSERA_TRY_ASSIGN(options.wish, surface_wish(a));
    options.samples = a.samples;
    {
        Progress progress("tessera bake", a.texture.quiet || a.encode.json);
        options.run = bake_run(a, progress.function());
        TESSERA_TRY_ASSIGN(
            baked.layers,
            corpus::bake_scene_layers(corpus::with_surfaces(scene), options).with_context(a.scene));
    }
    baked.density = baked.layers.density;
    baked.facts = scene_facts(a, baked.density, background_fact(scene));
    baked.json = {{"scene", a.scene}, {"samples_per_texel", a.samples}};
    baked.remark = format_number(baked.density, 3) + " texels per unit";
    return write_layers(a, baked, Warnings(a.encode.strict));
}

} // namespace tessera
