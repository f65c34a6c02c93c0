// The arguments of `tessera fit`, and its two kinds of fits.
#pragma once

#include "corpus/fit/photo_solver.h"
#include "tools/support/encode_arguments.h"
#include "tools/support/json_text.h"
#include "tools/support/texture_arguments.h"
#include "tools/support/warnings.h"
#include "tools/verbs/photograph_figures.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tessera {

struct FitCommand {
    std::string photographs, mesh, output;
    std::string surface; // sphere or planar; empty: the mesh
    std::string images, masks, background, pixel_filter;
    std::string centre; // of the sphere, "x,y,z"
    std::string unseen; // fill or dont-care; empty: fill
    std::optional<double> radius, focus;
    std::optional<unsigned> hold_out;
    std::optional<double> density, texels, smoothness;
    std::optional<unsigned> directions, shared_directions, cell;
    bool y_up = false, no_corrections = false;
    TextureArguments texture; // threads and quiet
    EncodeArguments encode;

    bool masks_unseen() const { return unseen == "dont-care"; }
};

// The photographs that are fitted, and those that are kept out to measure the fit.
struct SplitPhotographs {
    std::vector<corpus::PosedPhotograph> fitted, held_out;
};

// Sets what all fits have in common. Errors: bad_argument, with the option.
Status set_solve_options(const FitCommand& a, corpus::PhotoSolveOptions& options);

// The facts of all fits as metadata, after those of the surface.
Metadata fit_metadata(const FitCommand& a, const corpus::PhotoFindings& found,
                      std::size_t photographs,
                      std::vector<std::pair<std::string, std::string>> facts);

// Names photographs that were left out or moved. Errors: those of Warnings::add().
Status add_fit_warnings(const corpus::PhotoFindings& found,
                        std::span<const corpus::PosedPhotograph> photographs, Warnings& warnings);

// Draws the photographs' views from the written file and compares them with the photographs.
Result<std::vector<ComparedPhotograph>>
measure_fit(const FitCommand& a, const corpus::PhotoFindings& found,
            std::span<const corpus::PosedPhotograph> photographs, const corpus::PixelFilter& filter,
            const ProgressFunction& show);

// The findings as members of the JSON of a fit, and as lines for people. `surface` is the word for
// what pixels see: "mesh".
void add_fit_findings(const corpus::PhotoFindings& found,
                      std::span<const corpus::PosedPhotograph> photographs,
                      const std::vector<ComparedPhotograph>& held_out, Json& json);
void print_fit_findings(const corpus::PhotoFindings& found, std::size_t photographs,
                        const char* surface);

// Fits to the mesh of the command, or to its sphere or window, writes the file and reports.
Status fit_mesh(const FitCommand& a, const SplitPhotographs& photographs, Warnings& warnings);
Status fit_views(const FitCommand& a, const SplitPhotographs& photographs, Warnings& warnings);

} // namespace tessera
