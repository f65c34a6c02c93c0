#include "corpus/fit/photo_fit.h"
#include "corpus/trace/ray_model.h"
#include "tools/support/encode_report.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/verbs/encode_layers.h"
#include "tools/verbs/fit_arguments.h"

#include <chrono>
#include <cstdio>

namespace tessera {
namespace {

// The model where its file places it, or turned from y up to z up.
Result<corpus::Model> load_fit_mesh(const FitCommand& a) {
    TESSERA_TRY_ASSIGN(corpus::Model model, corpus::load_model(a.mesh));
    corpus::restore_placement(model);
    if (a.y_up)
        for (corpus::ModelVertex& vertex : model.vertices) {
            const auto turn = [](const glm::vec3& v) { return glm::vec3(v.x, -v.z, v.y); };
            vertex.position = turn(vertex.position);
            vertex.normal = turn(vertex.normal);
        }
    return corpus::with_both_sides(std::move(model)).with_context(a.mesh);
}

Result<corpus::PhotoFitOptions> mesh_options(const FitCommand& a) {
    corpus::PhotoFitOptions options;
    TESSERA_TRY(set_solve_options(a, options));
    options.density = a.density.value_or(options.density);
    options.most_texels = a.texels.value_or(options.most_texels);
    options.directions = a.directions.value_or(options.directions);
    options.shared_directions = a.shared_directions.value_or(options.shared_directions);
    options.cell = a.cell.value_or(options.cell);
    options.masks_unseen = a.masks_unseen();
    return options;
}

struct MeshFit {
    corpus::PhotoFit fit;
    CodedLayers coded;
    std::vector<ComparedPhotograph> held_out;
    double seconds = 0;
};

void report_mesh_fit(const FitCommand& a, const MeshFit& r, const SplitPhotographs& photographs,
                     const Warnings& warnings) {
    if (a.encode.json) {
        Json json = {
            {"output", a.output},
            {"bytes", r.coded.file.size()},
            {"mesh_bytes", r.fit.layers.mesh.size()},
            {"quality", r.coded.quality ? Json(*r.coded.quality) : Json(nullptr)},
            // JSON has no infinity.
            {"psnr", r.coded.sum_psnr >= lossless_psnr ? Json(nullptr) : Json(r.coded.sum_psnr)},
            {"seconds", r.seconds},
            {"texels_per_unit", r.fit.layers.density},
            {"layers", layers_json(r.coded)},
            {"warnings", warnings.json()}};
        add_fit_findings(r.fit, photographs.fitted, r.held_out, json);
        print_json(json);
        return;
    }
    warnings.print("fit");
    if (a.texture.quiet)
        return;
    std::printf("%s: %s in %.1f s, %s\n", a.output.c_str(),
                human_bytes(r.coded.file.size()).c_str(), r.seconds, rate_text(r.coded).c_str());
    print_fit_findings(r.fit, photographs.fitted.size(), "mesh");
    print_layers(stdout, r.fit.layers, r.coded);
    if (!r.held_out.empty())
        print_photographs("held out", figures_of(r.held_out), r.held_out);
}

} // namespace

Status fit_mesh(const FitCommand& a, const SplitPhotographs& photographs, Warnings& warnings) {
    const auto start = std::chrono::steady_clock::now();
    TESSERA_TRY_ASSIGN(const corpus::Model model, load_fit_mesh(a));
    TESSERA_TRY_ASSIGN(corpus::PhotoFitOptions options, mesh_options(a));
    MeshFit result;
    {
        Progress progress("tessera fit", a.texture.quiet || a.encode.json);
        options.run.progress = progress.function();
        TESSERA_TRY_ASSIGN(result.fit, corpus::fit_photographs(model, photographs.fitted, options)
                                           .with_context(a.photographs));
        TESSERA_TRY(add_fit_warnings(result.fit, photographs.fitted, warnings));
        const std::string frame = a.y_up ? "of the cameras; the model was turned from y up to z up"
                                         : "of the cameras and the model";
        Metadata metadata =
            fit_metadata(a, result.fit, photographs.fitted.size(),
                         {{"model", a.mesh},
                          {"texels per unit", format_digits(result.fit.layers.density, 6)},
                          {"frame", frame}});
        TESSERA_TRY_ASSIGN(EncodeOptions encode, make_encode_options(a.encode, a.texture.threads,
                                                                     std::move(metadata), {}));
        encode.mesh = result.fit.layers.mesh;
        encode.progress = options.run.progress;
        encode.cancelled = options.run.cancelled;
        TESSERA_TRY_ASSIGN(result.coded,
                           encode_layers(result.fit.layers, encode, rate_of_layers(a.encode))
                               .with_context(a.output));
        TESSERA_TRY(make_parent_folders(a.output));
        TESSERA_TRY(write_bytes(a.output, result.coded.file));
        if (!photographs.held_out.empty()) {
            TESSERA_TRY_ASSIGN(result.held_out, measure_fit(a, result.fit, photographs.held_out,
                                                            options.filter, options.run.progress));
        }
    }
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report_mesh_fit(a, result, photographs, warnings);
    return {};
}

} // namespace tessera
