// The default parameters, from the normative tables. They were fitted to files of the corpus by
// tests/regression/train_defaults.
#include "format/tile/code_tables.h"

namespace tessera {

const Parameters& default_parameters(DefaultSet set) {
    static constexpr Parameters::Values view_values = {
#include "format/tables/default_parameters.inc"
    };
    static constexpr Parameters::Values picture_values = {
#include "format/tables/picture_parameters.inc"
    };
    static const Parameters views(view_values), pictures(picture_values);
    return set == DefaultSet::pictures ? pictures : views;
}

} // namespace tessera
